// What people and machines do, in the words of the server (src/api/access/acts.rs), in its order.

export const ACTS = [
  'stop_fleet', 'resume_fleet', 'evacuate', 'end_evacuation', 'close_area', 'open_area', 'pause_robot', 'resume_robot',
  'start_maintenance', 'end_maintenance', 'add_robot', 'remove_robot', 'submit_job', 'submit_jobs', 'change_job', 'cancel_job',
  'reassign_job', 'assign_task', 'cancel_task', 'finish_task', 'register_worker', 'clear_worker', 'narrow_worker', 'sign_off',
  'erase_person', 'acknowledge_alarm', 'confirm_line', 'repeat_line', 'release_rack', 'finish_pick', 'report_missing', 'pause_station',
  'resume_station', 'take_rack', 'publish_map', 'add_kind', 'remove_kind', 'add_webhook', 'remove_webhook', 'make_token', 'renew_token',
  'revoke_token', 'sign_in', 'sign_out', 'shelve_alarm', 'unshelve_alarm', 'note_alarm',
] as const;
export type Act = (typeof ACTS)[number];
