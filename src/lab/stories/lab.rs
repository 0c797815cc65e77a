//! The laboratory: a robot closes the way to the first goal (Petković 2021, section 3.5.2, figures 3.14 and 3.15).
//!
//! Main function: [`tell`]. Two things differ from the text, since our plan of the laboratory is a guess: the moving
//! robot starts at the charger beside R107, and robots are discs of 0.7 m radius instead of 1 m, because with 1 m the
//! robot that stands at R15 would close the street behind it, too.

use super::actor::{Actor, StoryAct};
use super::{Story, StoryEvent, name};
use giveway_floor::geometry::Point;
use giveway_floor::id::GoalId;
use giveway_floor::time::Time;
use giveway_floor::warehouse::walkway::Walkways;
use giveway_floor::warehouse::{Warehouse, lab};
use giveway_people::human::{Distances, Intention, Method, Model};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

/// Radius of what a robot closes, metres.
const ROBOT_M: f64 = 0.7;
/// Poses per second.
const RATE: f64 = 10.0;
const GOALS: [(&str, &str); 3] = [("R117", "#8e44ad"), ("R109", "#17a2b8"), ("R17", "#8b5a2b")];

/// The person's acts. Events refer to them by number.
fn person() -> Actor {
    let pace = 0.9;
    Actor::new(
        Point::new(6.0, 0.0),
        FRAC_PI_2,
        &[
            StoryAct::Walk(6.0, 2.4, 0.6),
            StoryAct::Stand(0.6),
            StoryAct::Turn(PI, 1.5),
            StoryAct::Walk(6.0, 0.0, pace),
            StoryAct::Walk(3.0, 0.0, pace),
            StoryAct::Walk(2.0, 0.0, pace),
            StoryAct::Walk(0.0, 0.0, pace),
            StoryAct::Walk(0.0, 1.5, pace),
            StoryAct::Stand(1.0),
            StoryAct::Turn(PI, 2.0),
            StoryAct::Walk(0.0, 0.0, pace),
            StoryAct::Walk(3.0, 0.0, pace),
            StoryAct::Walk(3.0, -1.2, 0.45),
            StoryAct::Stand(1.0),
        ],
    )
}

fn robot() -> Actor {
    let drive = |x, y| StoryAct::Walk(x, y, 0.8);
    Actor::new(
        Point::new(5.0, 5.0),
        -FRAC_PI_2,
        &[StoryAct::Stand(1.2), drive(5.0, 4.0), drive(6.0, 4.0), drive(6.0, 3.0)],
    )
}

fn place(w: &Warehouse, node: &str) -> Point {
    w.node_named(node).map(|n| w.nodes[n].at).expect("a node of the laboratory")
}

/// Tells the story.
pub(super) fn tell(method: Method) -> Story {
    let w = lab();
    let mut all = Distances::over(Arc::new(Walkways::of(&w)));
    let mut recogniser = Intention::new(method, &Model::builtin());
    for (i, (goal, _)) in GOALS.iter().enumerate() {
        all.add_goal(GoalId(i as u64), place(&w, goal));
        recogniser.add_goal(GoalId(i as u64), 1.0).expect("three goals");
    }
    let (person, robot, standing) = (person(), robot(), place(&w, "R15"));
    let (mut beliefs, mut closed) = (Vec::new(), None);
    for tick in 0..=(person.end() * RATE) as i64 {
        let t = tick as f64 / RATE;
        let mut cut = all.walkways().expect("a hall has walkways").no_edges();
        for at in [standing, robot.pose(t).at] {
            for e in all.walkways().expect("a hall has walkways").edges_within(at, ROBOT_M) {
                if cut.insert(e) && at != standing && closed.is_none() {
                    closed = Some(t);
                }
            }
        }
        all.set_cut(&cut);
        let pose = person.pose(t);
        recogniser.observe(Time::from_secs_f64(t), pose.at, Some(pose.heading), &all);
        beliefs.push((t, recogniser.belief()));
    }
    let events = [
        (0.0, "walks north from R32: fits R117 only"),
        (closed.expect("the robot closes the way"), "the robot closes the way at R107, then at R101"),
        (person.begins(2), "turns round"),
        (person.begins(3), "walks back and west: fits all three"),
        (person.begins(5), "passes the turn to R17"),
        (person.begins(7), "turns north towards R109"),
        (person.begins(8), "stops before R109 and turns round"),
        (person.begins(10), "walks back: fits R17 only"),
        (person.begins(12), "passes the turn to R17 again, bound for the station P"),
    ];
    Story {
        title: "The laboratory".into(),
        subtitle: format!("{}; goals R117, R109 and R17; one robot stands at R15, one moves", name(method)),
        unit: "seconds",
        goals: GOALS.to_vec(),
        beliefs,
        events: events.into_iter().map(|(at, what)| StoryEvent { at, what: what.into() }).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_people::human::Belief;
    use giveway_people::human::intention::IntentState;

    const R117: GoalId = GoalId(0);
    const R109: GoalId = GoalId(1);
    const R17: GoalId = GoalId(2);

    /// Checks the order of events that the thesis tells, for methods with and without *undecided*.
    fn tells(method: Method, is_undecided: impl Fn(&Belief) -> bool) {
        let story = tell(method);
        let at = |words: &str, later: f64| story.at(story.when(words) + later);
        assert_eq!(at("robot closes", -0.1).top(), IntentState::Goal(R117), "{method:?}");
        assert_eq!(
            at("turns round", -0.3).top(),
            IntentState::Elsewhere,
            "{method:?}: it walks on to a closed way"
        );
        let back = at("passes the turn to R17", -1.5);
        assert!(is_undecided(back) && back.elsewhere < 0.1, "{method:?}: all three fit: {back:?}");
        let passed = at("turns north", 0.0);
        let least = passed.of(R117).min(passed.of(R109));
        assert!(
            passed.of(R17) < 0.05 && least > 3.0 * passed.of(R17),
            "{method:?}: R17 was passed: {passed:?}"
        );
        // Our method remembers the walk north, which only fitted R117.
        let apart = if method == Method::Detour { 0.8 } else { 0.1 };
        assert!(
            (passed.of(R117) - passed.of(R109)).abs() < apart,
            "{method:?}: R109 lies on the way to R117"
        );
        assert_eq!(
            at("again", -1.0).top(),
            IntentState::Goal(R17),
            "{method:?}: the only goal on the way back"
        );
        let bound_away = at("again", 2.4);
        assert_eq!(bound_away.top(), IntentState::Elsewhere, "{method:?}: {bound_away:?}");
        assert!(story.beliefs.iter().all(|(_, b)| (b.sum() - 1.0).abs() < 1e-9));
    }

    #[test]
    fn the_order_of_events_is_that_of_the_thesis_with_its_method() {
        tells(Method::Chapter3, |b| b.top() == IntentState::Undecided);
    }

    #[test]
    fn the_order_of_events_is_that_of_the_thesis_with_detours() {
        tells(Method::Detour, |b| b.goals.iter().all(|g| (0.1..0.8).contains(&g.1)));
    }
}
