//! Training data: movements of people, and how people are left out.
//!
//! Main type: [`PickLessons`]. Refuses: movements of one person on both sides of a cut.

use super::items::ReachItem;
use crate::picks::{GazeTrial, PickRecording};
use std::collections::BTreeMap;

/// Movements and eyes of people.
#[derive(Clone, Debug, Default)]
pub struct PickLessons {
    /// Names of the data sources.
    pub sources: Vec<String>,
    /// Names of people; [`ReachItem::person`] counts them.
    pub people: Vec<String>,
    /// Movements, each among the places of its distance.
    pub items: Vec<ReachItem>,
    /// Names of places; [`ReachItem::places`] counts them.
    pub places: Vec<String>,
    /// Movements among fixed lists of places: one list of movements for each list of places.
    pub lists: Vec<Vec<ReachItem>>,
    /// Eyes and heads.
    pub gaze: Vec<GazeTrial>,
}

impl PickLessons {
    /// The lessons from all movements of recordings.
    pub fn of(recordings: &[(String, PickRecording)]) -> PickLessons {
        let mut lessons = PickLessons::default();
        for (name, recording) in recordings {
            lessons.add(name, recording);
        }
        lessons
    }

    fn add(&mut self, name: &str, recording: &PickRecording) {
        self.sources.push(format!("{name} ({} movements)", recording.reaches.len()));
        let first = self.people.len();
        self.people.extend(recording.people.iter().cloned());
        let names: Vec<&str> = recording.places.iter().map(|p| p.name.as_str()).collect();
        let mut number = |name: &&str| {
            self.places.iter().position(|p| p == name).unwrap_or_else(|| {
                self.places.push((*name).to_owned());
                self.places.len() - 1
            })
        };
        let numbers: Vec<usize> = names.iter().map(&mut number).collect();
        // The names of places of one distance end in the same character.
        let mut layers: BTreeMap<Option<char>, Vec<usize>> = BTreeMap::new();
        for (i, name) in names.iter().enumerate() {
            layers.entry(name.chars().last()).or_default().push(i);
        }
        let all: Vec<usize> = (0..names.len()).collect();
        let mut lists: Vec<Vec<usize>> = layers.values().filter(|l| l.len() > 1).cloned().collect();
        lists.push(all.clone());
        self.lists.resize(lists.len().max(self.lists.len()), Vec::new());
        for (n, reach) in recording.reaches.iter().enumerate() {
            let of = |list: &[usize]| {
                let mut item = ReachItem::of(recording, reach, list)?;
                item.person += first;
                item.places.iter_mut().for_each(|p| *p = numbers[*p]);
                Some(item)
            };
            for (list, known) in lists.iter().zip(&mut self.lists) {
                known.extend(of(list));
            }
            let layer = lists.iter().find(|l| l.contains(&reach.place)).unwrap_or(&all);
            // Some movements are learned among all places.
            let list = if n % 4 == 0 { &all } else { layer };
            self.items.extend(of(list));
        }
        self.gaze.extend(recording.gaze.iter().cloned());
    }

    /// The lessons of some people.
    pub fn only(&self, is_one: impl Fn(usize) -> bool) -> PickLessons {
        let of = |items: &[ReachItem]| items.iter().filter(|i| is_one(i.person)).cloned().collect();
        PickLessons {
            sources: self.sources.clone(),
            people: self.people.clone(),
            items: of(&self.items),
            places: self.places.clone(),
            lists: self.lists.iter().map(|l| of(l)).collect(),
            gaze: self.gaze.clone(),
        }
    }

    /// Indices of the people with movements.
    pub fn present(&self) -> Vec<usize> {
        let all: std::collections::BTreeSet<usize> = self.items.iter().map(|i| i.person).collect();
        all.into_iter().collect()
    }

    /// The group of a person, out of `groups`.
    pub fn group(&self, person: usize, groups: usize) -> usize {
        self.present().iter().position(|p| *p == person).unwrap_or(0) % groups
    }
}
