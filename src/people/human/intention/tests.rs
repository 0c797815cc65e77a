//! Recognisers on the shipped maps.

use super::*;
use crate::human::tiles::Tiles;
use giveway_floor::geometry::{Segment, Vector};
use giveway_floor::time::Span;
use giveway_floor::warehouse::walkway::Walkways;
use giveway_floor::warehouse::{Warehouse, lab, thesis};
use std::sync::Arc;

const METHODS: [Method; 4] = [Method::Chapter3, Method::Chapter3Tiles, Method::Chapter4, Method::Detour];

fn p(x: f64, y: f64) -> Point {
    Point::new(x, y)
}

fn floor(w: &Warehouse, goals: &[Point]) -> Distances {
    let walkways = Arc::new(Walkways::of(w));
    let tiles = Tiles::of(w, &walkways).expect("a small floor");
    let mut distances = Distances::over(walkways).with_tiles(tiles);
    goals.iter().enumerate().for_each(|(i, at)| distances.add_goal(GoalId(i as u64), *at));
    distances
}

fn recogniser(method: Method, goals: usize) -> Intention {
    let mut person = Intention::new(method, &Model::builtin());
    (0..goals).for_each(|g| person.add_goal(GoalId(g as u64), 1.0).expect("room"));
    person
}

/// Walks along corners at 1.2 m/s and observes a pose every `period`; gives the belief every second.
fn walk(person: &mut Intention, corners: &[Point], period: Span, all: &Distances) -> Vec<Belief> {
    let (mut seen, mut beliefs, mut second) = (Time::ZERO, Vec::new(), Time::ZERO);
    for pair in corners.windows(2) {
        let leg = Segment { a: pair[0], b: pair[1] };
        let takes = leg.length() / 1.2;
        let start = seen;
        while (seen - start).as_secs_f64() < takes {
            let at = leg.point((seen - start).as_secs_f64() / takes);
            person.observe(seen, at, Some(leg.heading()), all);
            if seen >= second {
                beliefs.push(person.belief());
                second += Span::from_secs(1);
            }
            seen += period;
        }
    }
    beliefs
}

#[test]
fn walking_to_a_goal_counts_fully_and_walking_away_not_at_all() {
    let all = floor(&thesis(), &[p(3.0, 12.0), p(3.0, 0.0)]);
    let goals = [GoalId(0), GoalId(1)];
    for y in [2.0, 4.3, 9.0] {
        let step = |dy: f64, heading: Option<f64>| {
            motion::validate(&all, &goals, p(3.0, y), p(3.0, y + dy), heading)
        };
        for heading in [None, Some(std::f64::consts::FRAC_PI_2)] {
            let v = step(0.3, heading);
            assert!(v[0] > 0.93 && v[1] < 0.07, "north from {y}: {v:?}");
        }
        for heading in [None, Some(-std::f64::consts::FRAC_PI_2)] {
            let v = step(-0.3, heading);
            assert!(v[0] < 0.07 && v[1] > 0.93, "south from {y}: {v:?}");
        }
        // Walking backwards is not walking away, but not as good either.
        let v = step(0.3, Some(-std::f64::consts::FRAC_PI_2));
        assert!(v[0] > 0.1 && v[0] < 0.9, "backwards from {y}: {v:?}");
    }
}

#[test]
fn a_turn_on_the_spot_counts_by_where_it_ends() {
    let all = floor(&thesis(), &[p(3.0, 12.0)]);
    let turn =
        |heading: f64| motion::validate(&all, &[GoalId(0)], p(3.0, 4.0), p(3.0, 4.0), Some(heading))[0];
    assert!(turn(std::f64::consts::FRAC_PI_2) > 0.95 && turn(-std::f64::consts::FRAC_PI_2) < 0.05);
    // Without a heading, a standing person gives no evidence.
    assert_eq!(motion::validate(&all, &[GoalId(0)], p(3.0, 4.0), p(3.0, 4.0), None), [0.5]);
}

#[test]
fn a_goal_that_is_closed_off_is_not_approached_and_makes_no_nonsense() {
    let mut all = floor(&lab(), &[p(4.0, 4.0)]);
    let mut cut = all.walkways().expect("a floor").no_edges();
    for at in [p(5.0, 4.0), p(3.0, 4.0)] {
        for e in all.walkways().expect("a floor").edges_within(at, 0.6) {
            cut.insert(e);
        }
    }
    all.set_cut(&cut);
    assert_eq!(motion::validate(&all, &[GoalId(0)], p(6.0, 1.0), p(6.0, 1.3), None), [0.0]);
    for method in METHODS {
        let mut person = recogniser(method, 1);
        for belief in walk(&mut person, &[p(6.0, 0.0), p(6.0, 3.0)], Span::from_millis(100), &all) {
            assert!((belief.sum() - 1.0).abs() < 1e-9, "{method:?} {belief:?}");
        }
    }
}

#[test]
fn beliefs_sum_to_one_and_the_goal_that_is_walked_to_wins() {
    // In the middle of aisles: the ways to the corners part late.
    let goals = [p(0.0, 10.0), p(12.0, 10.0), p(0.0, 3.0), p(12.0, 4.0)];
    let all = floor(&thesis(), &goals);
    for method in METHODS {
        for (i, goal) in goals.iter().enumerate() {
            let way = all.walkways().expect("a floor").path(p(6.0, 7.0), *goal, all.cut()).expect("a way");
            let mut person = recogniser(method, goals.len());
            let beliefs = walk(&mut person, &way.points, Span::from_millis(100), &all);
            for belief in &beliefs {
                assert!((belief.sum() - 1.0).abs() < 1e-9, "{method:?} {belief:?}");
                assert!(belief.goals.iter().all(|g| (0.0..=1.0).contains(&g.1)), "{belief:?}");
            }
            let (first, last) = (&beliefs[0], person.belief());
            let id = GoalId(i as u64);
            if method == Method::Chapter3Tiles {
                // On the last tiles every action is nearly as good as going on, and the published method doubts again.
                let sure = |b: &&Belief| b.top() == IntentState::Goal(id) && b.of(id) > 0.6;
                assert!(beliefs.iter().any(|b| sure(&b)), "to {goal}: {beliefs:?}");
                assert!(last.goals.iter().all(|g| g.0 == id || g.1 < last.of(id)), "to {goal}: {last:?}");
                continue;
            }
            assert_eq!(last.top(), IntentState::Goal(id), "{method:?} to {goal}: {last:?}");
            assert!(last.of(id) > 0.6 && last.of(id) > first.of(id), "{method:?} to {goal}: {last:?}");
        }
    }
}

#[test]
fn a_fast_stream_of_poses_means_no_more_than_a_slow_one() {
    let goals = [p(0.0, 13.0), p(12.0, 12.0), p(0.0, 0.0), p(12.0, 0.0)];
    let all = floor(&thesis(), &goals);
    let corners = [p(6.0, 7.0), p(3.0, 7.0), p(3.0, 0.0), p(6.0, 0.0), p(6.0, 6.0)];
    let [slow, fast] = [400_000, 16_667].map(|us| {
        let mut person = recogniser(Method::Detour, goals.len());
        walk(&mut person, &corners, Span(us), &all)
    });
    // Steps of half a metre detect a turn a little later than steps of a quarter, so the average counts.
    let apart =
        |(a, b): (&Belief, &Belief)| (0..4).map(|g| (a.of(GoalId(g)) - b.of(GoalId(g))).abs()).sum::<f64>();
    let mean = slow.iter().zip(&fast).map(apart).sum::<f64>() / slow.len() as f64 / 4.0;
    assert!(slow.len() > 15 && mean < 0.05, "{mean} on average over {} s", slow.len());
    let ends = [&slow, &fast].map(|b| b[b.len() - 1].clone());
    assert_eq!(ends[0].top(), ends[1].top());
}

#[test]
fn noise_of_a_standing_person_decides_nothing() {
    let all = floor(&thesis(), &[p(0.0, 13.0), p(12.0, 0.0)]);
    for method in METHODS {
        let mut person = recogniser(method, 2);
        let before = person.belief();
        for k in 0..600 {
            let jitter = Vector::new(f64::from(k * 37 % 11) - 5.0, f64::from(k * 53 % 13) - 6.0) * 0.004;
            person.observe(Time(i64::from(k) * 16_667), p(6.0, 7.0) + jitter, None, &all);
        }
        let after = person.belief();
        for g in [GoalId(0), GoalId(1)] {
            assert!((before.of(g) - after.of(g)).abs() < 0.12, "{method:?}: {before:?} {after:?}");
        }
    }
}

#[test]
fn the_workers_own_task_is_believed_first() {
    let mut person = Intention::new(Method::Detour, &Model::builtin());
    person.add_goal(GoalId(0), 1.0).expect("room");
    person.add_goal(GoalId(1), 8.0).expect("room");
    assert!(person.belief().of(GoalId(1)) > 0.8);
}

#[test]
fn goals_come_and_go_while_a_person_walks() {
    let mut all = floor(&thesis(), &[p(0.0, 13.0), p(12.0, 12.0)]);
    for method in METHODS {
        let mut person = recogniser(method, 2);
        walk(&mut person, &[p(6.0, 7.0), p(3.0, 7.0)], Span::from_millis(100), &all);
        all.add_goal(GoalId(9), p(3.0, 1.0));
        person.add_goal(GoalId(9), 1.0).expect("room");
        let fresh = person.belief();
        assert!((fresh.sum() - 1.0).abs() < 1e-9 && fresh.of(GoalId(9)) > 0.02, "{method:?} {fresh:?}");
        walk(&mut person, &[p(3.0, 7.0), p(3.0, 1.0)], Span::from_millis(100), &all);
        let last = person.belief();
        let others = last.goals.iter().filter(|g| g.0 != GoalId(9));
        assert!(others.map(|g| g.1).sum::<f64>() < 0.5 * last.of(GoalId(9)), "{method:?} {last:?}");
        person.remove_goal(GoalId(9));
        all.remove_goal(GoalId(9));
        let left = person.belief();
        assert!((left.sum() - 1.0).abs() < 1e-9 && left.goals.len() == 2, "{method:?} {left:?}");
    }
}

#[test]
fn chapter_three_has_room_for_nine_goals_and_doubts_more_than_five() {
    let mut person = Intention::new(Method::Chapter3, &Model::builtin());
    for g in 0..9 {
        assert_eq!(person.is_doubtful(), g > 5);
        person.add_goal(GoalId(g), 1.0).expect("room for nine");
    }
    let refused = person.add_goal(GoalId(9), 1.0).expect_err("no room for ten");
    assert_eq!(refused.to_string(), "this method has room for 9 goals");
    person.add_goal(GoalId(3), 1.0).expect("it has this one");
    assert_eq!(person.belief().goals.len(), 9);
}

#[test]
fn chapter_four_begins_with_all_goals_alike() {
    let belief = recogniser(Method::Chapter4, 5).belief();
    assert!(belief.goals.iter().all(|g| (g.1 - 0.2).abs() < 1e-12));
}

#[test]
fn the_most_probable_sequence_has_the_goals_in_the_order_in_which_they_were_walked_to() {
    // To the south-western corner first, half of the way; then to the north-eastern one.
    let goals = [p(0.0, 0.0), p(12.0, 10.0)];
    let all = floor(&thesis(), &goals);
    for method in METHODS {
        let mut person = recogniser(method, goals.len());
        let walkways = all.walkways().expect("a floor");
        let (start, turn) = (p(6.0, 7.0), p(3.0, 4.0));
        let mut corners = walkways.path(start, turn, all.cut()).expect("a way").points;
        let back = walkways.path(turn, goals[1], all.cut()).expect("a way").points;
        corners.extend(back.into_iter().skip(1));
        walk(&mut person, &corners, Span::from_millis(100), &all);
        let episodes = person.episodes();
        let to: Vec<u64> = episodes
            .iter()
            .filter_map(|e| if let IntentState::Goal(g) = e.state { Some(g.0) } else { None })
            .collect();
        let mut order = to.clone();
        order.dedup();
        assert_eq!(order, [0, 1], "{method:?}: {episodes:?}");
        assert!(episodes.windows(2).all(|e| e[0].since <= e[1].since && e[0].state != e[1].state));
        assert_eq!(person.belief().top(), IntentState::Goal(GoalId(1)), "{method:?}");
    }
}
