//! The whole experiment in small: few people, few movements, few training steps.

use super::bench::{ObjectGroup, ObjectJob, ObjectPiece, ObjectsBench, ObjectsCourse};
use super::body::{FRAMES, GAZE, HAND, HEAD, ObjectTable};
use super::change::{CHANGES, changed_goal};
use super::nets::{ObjectWatch, random_net};
use super::report::{GroupReport, ObjectsReport, RowReport};
use super::rows::choice_of;
use super::study::feature_study;
use crate::learning::picks::PlaceVariant;
use giveway_sim::random::Stream;

const SMALL: ObjectsCourse = ObjectsCourse { people: 3, movements: 15, steps: 40, seed: 1 };

fn row<'a>(group: &'a GroupReport, word: &str) -> &'a RowReport {
    group.rows.iter().find(|r| r.word == word).unwrap_or_else(|| panic!("there is a row {word}"))
}

#[test]
fn one_fold_has_all_rows_of_its_table_and_the_same_seed_gives_the_same_figures() {
    let bench = ObjectsBench::new(SMALL);
    let job = ObjectJob::Fold(ObjectTable::Tables, 1, 2);
    let pieces = bench.run(7, job);
    assert_eq!(pieces, ObjectsBench::new(SMALL).run(7, job));
    let report = ObjectsReport::of(pieces);
    let group = &report.groups[&ObjectGroup::Within(ObjectTable::Tables)];
    let words: Vec<&str> = group.rows.iter().map(|r| r.word).collect();
    assert_eq!(words, ["hand", "head", "lstm", "mlp", "rnn", "full", "head_sharpened"]);
    for row in &group.rows {
        assert!((0.0..=360.0).contains(&row.score.auc_sum()) && row.score.error_sum() > 0.0, "{row:?}");
        assert_eq!(row.score.auc_sum(), row.score.auc_mean * 360.0);
    }
    assert_eq!(row(group, "head").score.auc_mean, row(group, "head_sharpened").score.auc_mean);
}

#[test]
fn folds_judge_every_movement_once_and_people_who_are_left_out_are_judged_by_others() {
    let bench = ObjectsBench::new(ObjectsCourse { steps: 1, ..SMALL });
    let jobs = bench.jobs();
    assert_eq!(jobs.len(), 3 * (5 + 1) + 3 * (3 + 1) + 3 * 3 + 3);
    let all = bench.moves(ObjectTable::Tables);
    assert_eq!(all.len(), 45);
    for person in 0..3 {
        let folds = (0..3).flat_map(|fold| bench.run(0, ObjectJob::Fold(ObjectTable::Tables, person, fold)));
        let judged: Vec<ObjectPiece> = folds.filter(|p| p.word == "hand").collect();
        assert!(judged.iter().all(|p| p.person == person));
        let of_folds = ObjectsReport::of(judged);
        let left_out = bench.run(0, ObjectJob::LeftOut(ObjectTable::Tables, person));
        let of_left_out = ObjectsReport::of(left_out.into_iter().filter(|p| p.word == "hand").collect());
        let score = |report: &ObjectsReport, group| row(&report.groups[&group], "hand").score;
        let a = score(&of_folds, ObjectGroup::Within(ObjectTable::Tables));
        let b = score(&of_left_out, ObjectGroup::LeftOut(ObjectTable::Tables));
        assert!((a.auc_mean - b.auc_mean).abs() < 1e-9, "a rule says the same of the same movements");
    }
}

#[test]
fn estimated_gaze_is_nearer_to_the_eyes_than_the_head_and_keeps_its_own_rows() {
    let bench = ObjectsBench::new(ObjectsCourse { movements: 30, ..SMALL });
    let report = ObjectsReport::of(bench.run(0, ObjectJob::Parts(0, 0)));
    let group = &report.groups[&ObjectGroup::Estimated];
    let words: Vec<&str> = group.rows.iter().map(|r| r.word).collect();
    assert_eq!(words, ["eg_lstm", "lstm_without_gaze", "gaze", "estimated_gaze", "hand", "head"]);
    assert_ne!(row(group, "gaze").score, row(group, "estimated_gaze").score);
    let [estimate, head] = group.degrees.expect("angles were counted");
    assert!(estimate.0 < head.0, "{estimate:?} {head:?}");
}

#[test]
fn gaze_is_the_best_single_feature_and_distances_of_joints_correlate() {
    let bench = ObjectsBench::new(SMALL);
    let study = feature_study(&bench.moves(ObjectTable::Shelves));
    for (i, row) in study.correlation.iter().enumerate() {
        assert!((row[i] - 1.0).abs() < 1e-9);
        assert!(row.iter().enumerate().all(|(j, c)| (c - study.correlation[j][i]).abs() < 1e-12));
    }
    assert!(study.correlation[3][6] > 0.9, "head and pelvis: {:?}", study.correlation[3]);
    assert!(study.merit[GAZE] > study.merit[HAND] && study.merit[GAZE] > study.merit[HEAD]);
    assert_eq!(study.selected[0], GAZE);
}

/// Figure 5.8 of the thesis: the order of events.
#[test]
fn an_object_that_comes_at_100_goes_at_180_and_comes_at_220_is_found_each_time() {
    let bench = ObjectsBench::new(ObjectsCourse { steps: 120, ..SMALL });
    let (judged, net) = bench.stranger();
    let [comes, goes, returns] = CHANGES;
    let mut found = 0;
    for m in &judged {
        let trace = changed_goal(&net, m).expect("weights are shared");
        for (k, p) in trace.changed.iter().enumerate() {
            let is_there = (comes..goes).contains(&k) || k >= returns;
            assert_eq!(p.is_some(), is_there, "frame {k}");
            assert!(is_there || !trace.is_first[k]);
        }
        // A new object is judged by its own last two seconds at once, and not by a neighbour's.
        for k in [comes, returns, FRAMES - 1] {
            let (with, without) = (trace.unchanged[k], trace.changed[k].expect("it is there"));
            assert!((with - without).abs() < 1e-6, "frame {k}: {with} {without}");
        }
        let first = |from: usize, to: usize| (from..to).find(|k| trace.is_first[*k]);
        if let (Some(once), Some(again)) = (first(comes, goes), first(returns, FRAMES)) {
            let order = [comes, once, goes, returns, again, FRAMES];
            assert!(order.is_sorted(), "{order:?}");
            found += usize::from(trace.is_first[FRAMES - 1]);
        }
    }
    assert!(found >= 4, "the order of the figure is seen in {found} of {} movements", judged.len());
}

#[test]
fn a_net_for_all_objects_together_takes_no_new_one() {
    let bench = ObjectsBench::new(ObjectsCourse { movements: 2, ..SMALL });
    let m = bench.moves(ObjectTable::Shelves)[0];
    let choice = choice_of(ObjectTable::Shelves);
    let net = random_net(PlaceVariant::Full, &choice, 4, m.objects.len(), &mut Stream::new(1, 1, 1));
    let mut watch = ObjectWatch::new(&net, &m.objects);
    watch.observe(&m.frames[0]);
    assert!(!watch.add(m.objects[0]) && !watch.remove(0));
    assert!(changed_goal(&net, m).is_none());
    assert_eq!(watch.probabilities().len(), 10);
}

#[test]
fn a_net_says_the_same_of_a_movement_at_once_and_frame_by_frame() {
    let bench = ObjectsBench::new(ObjectsCourse { movements: 2, ..SMALL });
    let m = bench.moves(ObjectTable::Shelves)[1];
    for variant in PlaceVariant::ALL {
        let choice = choice_of(ObjectTable::Shelves);
        let net = random_net(variant, &choice, 5, m.objects.len(), &mut Stream::new(2, 1, 1));
        let mut watch = ObjectWatch::new(&net, &m.objects);
        for (frame, whole) in m.frames.iter().zip(net.probabilities(m)) {
            watch.observe(frame);
            let single = watch.probabilities();
            assert!(single.iter().zip(&whole).all(|(a, b)| (a - b).abs() < 1e-4), "{variant:?}");
        }
    }
}
