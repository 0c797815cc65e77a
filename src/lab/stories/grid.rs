//! Tiles, three goals, a change of mind and a dead end (Petković 2021, section 3.5.1, figures 3.9 and 3.10).
//!
//! Main function: [`tell`]. The drawing of the original floor is lost; this one has the same choices in the same order.

use super::{Story, StoryEvent};
use giveway_people::human::intention::TileIntention;
use giveway_people::human::tiles::{Action, Stand, Tiles};

/// North up. Goal 0 is the northern one (Goal 1 of the thesis), goal 1 the eastern one (Goal 2), goal 2 the southern
/// one (Goal 3). A ring of streets with branches to all of them, and one to a dead end in the north.
const FLOOR: &str = "
####################
####################
####################
################.###
################.###
################.###
################.###
################.###
########..........1#
########.#######.###
########.#######.###
###0.....#######.###
########.#######.###
########.#######.###
#####....#######.###
########.#######.###
########.#######.###
########.#######.###
########2........###
####################
";

/// Runs of actions, a letter each, with the event text of each run.
const ACTS: [(&str, &str); 7] = [
    ("LL>>", "walks towards the crossing: fits all three goals"),
    ("R>Rvvvv", "turns south: fits goal 3 only"),
    (">", "leaves goal 3 behind, eastwards"),
    ("LL>>>>>>L>L", "goes on east: fits goal 2"),
    ("^^^^^^^^^^", "north: fits goals 1 and 2"),
    ("^^^^^", "goes straight on into a dead end"),
    ("SSS", "stands there"),
];

fn action(letter: char) -> Action {
    match letter {
        '^' => Action::Up,
        'v' => Action::Down,
        '<' => Action::Left,
        '>' => Action::Right,
        'R' => Action::TurnRight,
        'L' => Action::TurnLeft,
        _ => Action::Stay,
    }
}

/// The story; one step is one action.
pub(super) fn tell() -> Story {
    let tiles = Tiles::drawn(FLOOR);
    let mut person = TileIntention::new(&tiles).expect("three goals");
    let mut stand = Stand { x: 5, y: 5, eighth: 6 };
    let (mut beliefs, mut events) = (vec![(0.0, person.belief())], Vec::new());
    for (letters, what) in ACTS {
        events.push(StoryEvent { at: beliefs.len() as f64 - 1.0, what: what.into() });
        for action in letters.chars().map(action) {
            person.observe(&tiles, stand, action);
            stand = tiles.after(stand, action).expect("the story keeps to free tiles");
            beliefs.push((beliefs.len() as f64, person.belief()));
        }
    }
    Story {
        title: "Three goals on tiles".into(),
        subtitle:
            "Petković 2021, section 3.2: state values of a Markov decision process, chain with g + 2 states"
                .into(),
        unit: "step",
        goals: vec![
            ("goal 1 (north-west)", "#b7950b"),
            ("goal 2 (east)", "#2471a3"),
            ("goal 3 (south)", "#ca6f1e"),
        ],
        beliefs,
        events,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::id::GoalId;
    use giveway_floor::time::Time;
    use giveway_people::human::intention::IntentState;
    use giveway_people::human::{Belief, Distances, Intention, Method, Model};
    use std::f64::consts::FRAC_PI_4;

    #[test]
    fn the_order_of_events_is_that_of_the_thesis() {
        let story = tell();
        let at = |words: &str| story.when(words);
        let [one, two, three] = [0, 1, 2].map(GoalId);
        // All goals rise equally while all fit.
        let crossing = story.at(at("turns south"));
        assert!([one, two, three].iter().all(|g| crossing.of(*g) > 0.1) && crossing.undecided > 0.5);
        // Goal 3 rises steeply; when the person turns away it falls at once, and undecided comes before goal 2.
        assert!(story.at(at("turns south") + 5.0).of(three) > 0.8);
        let left = story.at(at("leaves goal 3") + 1.0);
        assert!(left.of(three) < 0.05 && left.top() == IntentState::Undecided, "{left:?}");
        // Goal 2 settles at about 0.85: undecided is never impossible.
        let plateau = [16.0, 18.0, 20.0].map(|t| story.at(t).of(two));
        assert!(plateau.iter().all(|p| (0.8..0.92).contains(p)), "{plateau:?}");
        // Two goals fit: neither wins. The dead end fits none.
        let both = story.at(at("straight on"));
        assert!(both.top() == IntentState::Undecided && both.elsewhere < 0.01, "{both:?}");
        let end = story.at(at("stands there"));
        assert!(end.elsewhere > 0.9, "{end:?}");
        assert!(story.beliefs.iter().all(|(_, b)| (b.sum() - 1.0).abs() < 1e-9));
    }

    /// The belief after each act of the story, by the method that a fleet can choose: from poses, ten a second.
    fn from_poses() -> Vec<Belief> {
        let tiles = Tiles::drawn(FLOOR);
        let floor = Distances::in_the_open().with_tiles(tiles.clone());
        let mut person = Intention::new(Method::Chapter3Tiles, &Model::builtin());
        tiles.goals().for_each(|g| person.add_goal(g, 1.0).expect("three goals"));
        let (mut stand, mut tick, mut beliefs) = (Stand { x: 5, y: 5, eighth: 6 }, 0, Vec::new());
        let mut heading = 6.0 * FRAC_PI_4;
        for (letters, _) in ACTS {
            for letter in letters.chars() {
                let next = tiles.after(stand, action(letter)).expect("the story keeps to free tiles");
                let turn = match letter {
                    'L' => FRAC_PI_4,
                    'R' => -FRAC_PI_4,
                    _ => 0.0,
                };
                for k in 1..=10 {
                    let u = f64::from(k) / 10.0;
                    let at = tiles.place(stand) + (tiles.place(next) - tiles.place(stand)) * u;
                    tick += 1;
                    person.observe(Time(tick * 100_000), at, Some(heading + turn * u), &floor);
                }
                (stand, heading) = (next, heading + turn);
            }
            beliefs.push(person.belief());
        }
        beliefs
    }

    #[test]
    fn poses_of_the_story_mean_the_actions_of_the_story() {
        let (story, after) = (tell(), from_poses());
        let mut steps = 0;
        for ((letters, what), seen) in ACTS.iter().zip(&after).take(ACTS.len() - 1) {
            steps += letters.len();
            let told = &story.beliefs[steps].1;
            let close = |a: f64, b: f64| (a - b).abs() < 1e-9;
            let goals = told.goals.iter().all(|(g, p)| close(*p, seen.of(*g)));
            assert!(goals && close(told.elsewhere, seen.elsewhere), "{what}: {told:?} {seen:?}");
        }
        assert!(after[1].of(GoalId(2)) > 0.3 && after[5].elsewhere > 0.9, "{after:?}");
        // A person who stands in the dead end is judged every second, not per letter.
        assert!(after[6].elsewhere > after[5].elsewhere, "{after:?}");
    }
}
