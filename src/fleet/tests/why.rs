//! Whoever asks why a job does not go on gets the reason.

use super::*;

impl Floor {
    fn why(&self, job: JobId) -> Option<JobWhy> {
        self.fleet.view(self.now).why_job(job, &self.fleet.ledger().jobs[&job])
    }
}

#[test]
fn a_waiting_job_says_what_it_waits_for() {
    let mut floor = Floor::lab(2);
    let first = floor.submit(request(deliver(3)));
    floor.until(60, "a robot has it", |f| f.is(first, "assigned"));
    let robot = floor.state(first).and_then(|s| s.robot()).expect("it is assigned");
    assert_eq!(floor.why(first), None, "it goes on");
    let after = floor.submit(JobRequest { after: vec![first], ..request(deliver(8)) });
    assert_eq!(floor.why(after), Some(JobWhy::After(first)));
    let same = floor.submit(request(deliver(3)));
    assert_eq!(floor.why(same), Some(JobWhy::RackBusy(RackId(3), robot, Some(first))), "being fetched");
    let named = floor.submit(request(JobKind::Park { robot }));
    assert_eq!(floor.why(named), Some(JobWhy::RobotBusy(robot, Some(first))));
    let second = floor.submit(request(deliver(8)));
    floor.until(60, "the other robot has it", |f| f.is(second, "assigned"));
    let third = floor.submit(request(deliver(5)));
    assert_eq!(floor.why(third), Some(JobWhy::NoRobot));
    floor.until(300, "the rack is carried", |f| f.is(first, "carrying"));
    assert_eq!(floor.why(same), Some(JobWhy::RackBusy(RackId(3), robot, Some(first))));
}

#[test]
fn a_job_at_work_gives_the_reason_of_its_robot() {
    let mut floor = Floor::lab(4);
    let pick = Some(Span::from_secs(300));
    let long = |rack| request(JobKind::Deliver { rack: RackId(rack), station: StationId(0), pick });
    let jobs: Vec<JobId> = (2..6).map(|rack| floor.submit(long(rack))).collect();
    let full = |f: &Floor, job: &JobId| {
        let robot = f.state(*job).and_then(|s| s.robot());
        robot.is_some_and(|r| f.why(*job) == Some(JobWhy::Robot(r, Why::QueueFull(StationId(0)))))
    };
    floor.until(300, "a rack waits for the queue", |f| jobs.iter().any(|j| full(f, j)));
}
