//! A rack that is wanted at several stations goes to all of them, in their order, and is put away once.

use super::*;

fn to_stations(rack: u32, stations: &[u32]) -> JobRequest {
    let visit = |s: &u32| Visiting { station: StationId(*s), pick: None };
    let mut request =
        request(JobKind::Deliver { rack: RackId(rack), station: StationId(stations[0]), pick: None });
    request.then = stations[1..].iter().map(visit).collect();
    request
}

impl TestFloor {
    fn served(&self, job: JobId) -> Vec<u32> {
        let job = self.fleet.ledger().jobs.get(&job);
        job.map(|j| j.served.iter().map(|(v, _)| v.station.0).collect()).unwrap_or_default()
    }
}

#[test]
fn a_rack_is_served_at_each_of_its_stations_and_lifted_and_put_away_once() {
    let mut floor = TestFloor::thesis(2);
    let job = floor.submit(to_stations(40, &[0, 1, 0]));
    floor.until(600, "the first station has served it", |f| f.served(job) == [0]);
    assert!(floor.is(job, "carrying"), "it goes on");
    floor.until(600, "the second has", |f| f.served(job) == [0, 1]);
    floor.until_over(600);
    assert_eq!(floor.story(job).last(), Some(&"done"));
    floor.until(300, "the rack is back", |f| matches!(f.rack(40), RackAt::Stored(_)));
    let lifts = floor.story(job).iter().filter(|w| **w == "assigned").count();
    assert_eq!(lifts, 1, "{:?}", floor.story(job));
    let ledger = floor.fleet.ledger();
    assert_eq!(ledger.counts.robot_deliveries, 3, "each station counts");
    assert_eq!((ledger.served[StationId(0)], ledger.served[StationId(1)]), (2, 1));
    assert_eq!(ledger.counts.done, 1, "but it is one job");
}

#[test]
fn many_deliveries_to_several_stations_all_end() {
    let mut floor = TestFloor::thesis(6);
    let jobs: Vec<JobId> = (0..18)
        .map(|i| floor.submit(to_stations(i * 3, if i % 2 == 0 { &[0, 1] } else { &[1, 0, 1] })))
        .collect();
    floor.until_over(3600);
    floor.assert_done_once(&jobs);
    assert_eq!(floor.fleet.ledger().counts.robot_deliveries, 9 * 2 + 9 * 3);
}

#[test]
fn it_can_be_cancelled_on_its_way_to_the_second_station() {
    let mut floor = TestFloor::thesis(1);
    let job = floor.submit(to_stations(40, &[0, 1]));
    floor.until(600, "the first station has served it", |f| f.served(job) == [0]);
    floor.cancel(job).unwrap();
    floor.until(300, "the robot has nothing to do", TestFloor::first_robot_is_idle);
    floor.assert_stored(40);
    assert_eq!(floor.fleet.ledger().counts.robot_deliveries, 1);
}

#[test]
fn missing_goods_end_the_job_at_that_station() {
    let mut floor = TestFloor::thesis(1);
    let job = floor.submit(to_stations(40, &[0, 1]));
    floor.until(600, "it stands there", |f| f.is(job, "picking"));
    let (station, order) = (StationId(0), StationOrder::Short);
    assert_eq!(floor.answer_to(5, vec![Input::ask(5, Request::Station(station, order))]), Ok(Answer::Done));
    assert_eq!(floor.story(job).last(), Some(&"failed"));
}

#[test]
fn a_station_twice_in_a_row_and_stations_of_other_jobs_are_refused() {
    let mut floor = TestFloor::thesis(1);
    let refused = |why| Err(why);
    assert_eq!(floor.ask(to_stations(40, &[0, 0])), refused(Refusal::Job(JobRefusal::SameStationTwice)));
    assert_eq!(floor.ask(to_stations(40, &[0, 99])), refused(Refusal::UnknownPlace));
    let then = vec![Visiting { station: StationId(0), pick: None }];
    let put = JobRequest { then, ..request(JobKind::Return { rack: RackId(1) }) };
    assert_eq!(floor.ask(put), refused(Refusal::Job(JobRefusal::SameStationTwice)));
}

#[test]
fn the_request_is_known_as_it_was_submitted() {
    let mut floor = TestFloor::thesis(1);
    let asked = to_stations(40, &[0, 1]);
    let job = floor.submit(asked.clone());
    floor.until(600, "the first station has served it", |f| f.served(job) == [0]);
    let record = &floor.fleet.ledger().jobs[&job];
    assert_eq!(record.submitted(), asked);
    assert_eq!(record.request.kind.station(), Some(StationId(1)), "what is wanted now");
}
