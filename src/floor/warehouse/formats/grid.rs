//! Grids of cells: what the benchmark formats have in common.
//!
//! Main type: [`LetterGrid`]. Cell names count rows from the top, as the formats do; positions have y up. Refuses:
//! to know what a letter means.

use super::{MapError, Options};
use crate::geometry::Point;
use crate::warehouse::{Draft, DraftLane, DraftNode, Users};

/// A rectangle of letters.
pub(super) struct LetterGrid {
    pub width: usize,
    pub height: usize,
    pub cells: Vec<u8>,
}

impl LetterGrid {
    /// Reads `height` rows of `width` letters out of `known`; `first_line` is the number of the first row.
    ///
    /// # Errors
    /// [`MapError::Syntax`] if there are more rows or fewer, or one has other letters or another width. Blank lines
    /// after the last row do not count as rows.
    pub fn read<'a>(
        rows: impl Iterator<Item = &'a str> + Clone,
        (width, height): (usize, usize),
        first_line: usize,
        known: &str,
    ) -> Result<LetterGrid, MapError> {
        let rows = rows.map(str::trim_end);
        let mut cells = Vec::new();
        let count =
            (1..).zip(rows.clone()).filter(|(_, row)| !row.is_empty()).map(|(n, _)| n).last().unwrap_or(0);
        if count != height {
            let message = format!("{count} rows, the header says {height}");
            return Err(MapError::syntax(first_line + count.min(height), 0, message));
        }
        for (line, row) in (first_line..).zip(rows).take(height) {
            if let Some(i) = row.chars().position(|c| !known.contains(c)) {
                return Err(MapError::syntax(line, i + 1, format!("cells must be one of \"{known}\"")));
            }
            if row.len() != width {
                let message = format!("{} cells in a row, the header says {width}", row.len());
                return Err(MapError::syntax(line, 0, message));
            }
            cells.extend(row.bytes());
        }
        Ok(LetterGrid { width, height, cells })
    }

    /// The cells right of, above, left of and below `c`, where they exist.
    pub fn around(&self, c: usize) -> impl Iterator<Item = usize> + use<> {
        let (x, y) = (c % self.width, c / self.width);
        let right = (x + 1 < self.width).then_some(c + 1);
        let above = (y > 0).then(|| c - self.width);
        let left = (x > 0).then(|| c - 1);
        let below = (y + 1 < self.height).then(|| c + self.width);
        [right, above, left, below].into_iter().flatten()
    }

    /// Whether each cell's letter is one of these.
    pub fn which(&self, letters: &str) -> Vec<bool> {
        self.cells.iter().map(|c| letters.as_bytes().contains(c)).collect()
    }

    pub fn name(&self, c: usize) -> String {
        format!("r{}c{}", c / self.width, c % self.width)
    }

    pub fn at(&self, c: usize, options: &Options) -> Point {
        let (x, y) = (c % self.width, self.height - 1 - c / self.width);
        Point::new(x as f64 * options.pitch_m, y as f64 * options.pitch_m)
    }

    pub fn draft(&self, options: &Options) -> Draft {
        Draft { name: options.name.clone(), footprint_m: 0.9 * options.pitch_m, ..Draft::default() }
    }

    pub fn add_node(&self, draft: &mut Draft, c: usize, options: &Options) {
        draft.nodes.push(DraftNode { name: self.name(c), at: self.at(c, options) });
    }

    /// Joins neighbours `a` and `b` both ways, for the users that `users(a, b)` gives, if any; asked once a pair.
    pub fn add_lanes(&self, draft: &mut Draft, users: impl Fn(usize, usize) -> Option<Users>) {
        for a in 0..self.cells.len() {
            for b in self.around(a).filter(|&b| b > a) {
                if let Some(users) = users(a, b) {
                    draft.lanes.push(DraftLane::both_ways(self.name(a), self.name(b), users));
                }
            }
        }
    }

    /// Lets people walk on the grid, with the cells that are not `open` as rectangular obstacles.
    pub fn add_outlines(&self, draft: &mut Draft, open: &[bool], options: &Options) {
        let mut blocks: Vec<(usize, usize)> = Vec::new();
        for row in 0..self.height {
            let cells = row * self.width..(row + 1) * self.width;
            let mut left = cells.start;
            for run in open[cells].chunk_by(|a, b| a == b) {
                let right = left + run.len() - 1;
                if !run[0] {
                    let above = (blocks.iter_mut().rev().take(self.width))
                        .find(|(l, r)| l % self.width == left % self.width && r + self.width == right);
                    match above {
                        Some(block) => block.1 = right,
                        None => blocks.push((left, right)),
                    }
                }
                left = right + 1;
            }
        }
        let outline = |left_top: usize, right_bottom: usize| {
            let half = nalgebra::Vector2::new(options.pitch_m, options.pitch_m) / 2.0;
            let (a, b) = (self.at(left_top, options), self.at(right_bottom, options));
            let (low, high) = (Point::new(a.x, b.y) - half, Point::new(b.x, a.y) + half);
            vec![low, Point::new(high.x, low.y), high, Point::new(low.x, high.y)]
        };
        draft.walkable.push(outline(0, self.cells.len() - 1));
        draft.obstacles.extend(blocks.into_iter().map(|(left, right)| outline(left, right)));
    }

    /// Removes from `floor` every cell outside its largest connected part; gives their number.
    pub fn keep_largest_part(&self, floor: &mut Vec<bool>) -> usize {
        let mut best: Vec<usize> = Vec::new();
        let mut seen: Vec<bool> = floor.iter().map(|free| !free).collect();
        for start in 0..floor.len() {
            if seen[start] {
                continue;
            }
            seen[start] = true;
            let (mut part, mut next) = (vec![start], 0);
            while next < part.len() {
                for c in self.around(part[next]) {
                    if !seen[c] {
                        seen[c] = true;
                        part.push(c);
                    }
                }
                next += 1;
            }
            if part.len() > best.len() {
                best = part;
            }
        }
        let before = floor.iter().filter(|free| **free).count();
        *floor = vec![false; floor.len()];
        best.iter().for_each(|&c| floor[c] = true);
        before - best.len()
    }

    /// Turns up to `most` of the cells in `may` into places: takes them off the floor such that the floor stays
    /// connected and every place keeps a floor cell beside it.
    ///
    /// A cell is taken if its free neighbours are joined to each other around it, within the eight cells that surround
    /// it: that is enough for the floor to stay connected, and can be checked locally. Dead ends and corners go first,
    /// then cells in a fixed scatter, so that the places spread over the floor.
    pub fn take_places(&self, floor: &mut [bool], may: &[bool], most: usize) -> Vec<bool> {
        let free_around = |c: usize, floor: &[bool]| self.around(c).filter(|&n| floor[n]).count();
        let mut order: Vec<usize> = (0..floor.len()).filter(|&c| floor[c] && may[c]).collect();
        let scatter = |c: usize| (c as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 20;
        order.sort_by_key(|&c| (free_around(c, floor), scatter(c)));
        let mut places = vec![false; floor.len()];
        let mut taken = 0;
        for c in order {
            if taken == most {
                break;
            }
            let keeps_access = (self.around(c).filter(|&n| places[n])).all(|n| free_around(n, floor) > 1);
            if keeps_access && self.is_spare(c, floor) {
                floor[c] = false;
                places[c] = true;
                taken += 1;
            }
        }
        places
    }

    /// Continues where [`LetterGrid::take_places`] stopped out of caution: takes up to `most` further cells whose free
    /// neighbours are joined to each other by any way around the cell, however long.
    pub fn take_more_places(&self, floor: &mut [bool], may: &[bool], places: &mut [bool], most: usize) {
        let mut taken = 0;
        for c in 0..floor.len() {
            if taken == most {
                break;
            }
            if !floor[c] || !may[c] {
                continue;
            }
            let mut around = self.around(c).filter(|&n| floor[n]);
            let Some(first) = around.next() else { continue };
            let rest: Vec<usize> = around.collect();
            let free_around = |n: usize| self.around(n).filter(|&m| floor[m]).count();
            let keeps_access = self.around(c).filter(|&n| places[n]).all(|n| free_around(n) > 1);
            if keeps_access && self.joined_without(c, first, rest, floor) {
                floor[c] = false;
                places[c] = true;
                taken += 1;
            }
        }
    }

    /// Whether one can walk over the floor from `first` to all of `rest` without `c`.
    fn joined_without(&self, c: usize, first: usize, mut rest: Vec<usize>, floor: &[bool]) -> bool {
        let mut seen = vec![false; floor.len()];
        seen[c] = true;
        seen[first] = true;
        let (mut queue, mut next) = (vec![first], 0);
        while next < queue.len() && !rest.is_empty() {
            for n in self.around(queue[next]).filter(|&n| floor[n]) {
                if !seen[n] {
                    seen[n] = true;
                    queue.push(n);
                    rest.retain(|&r| r != n);
                }
            }
            next += 1;
        }
        rest.is_empty()
    }

    /// Whether the free neighbours of `c` are joined to each other within the ring of cells around it.
    fn is_spare(&self, c: usize, floor: &[bool]) -> bool {
        let (x, y) = ((c % self.width) as isize, (c / self.width) as isize);
        let ring = [(0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1)].map(|(dx, dy)| {
            let (x, y) = (x + dx, y + dy);
            let within = x >= 0 && y >= 0 && x < self.width as isize && y < self.height as isize;
            within && floor[y as usize * self.width + x as usize]
        });
        // The ring's odd cells only touch `c` at a corner: a run of free cells counts if it has an even one.
        let neighbours = (0..8).step_by(2).filter(|&i| ring[i]).count();
        let joints = (0..8).step_by(2).filter(|&i| ring[i] && ring[i + 1] && ring[(i + 2) % 8]).count();
        neighbours > 0 && neighbours - joints.min(neighbours - 1) == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn grid(text: &str) -> LetterGrid {
        let rows: Vec<&str> = text.split_whitespace().collect();
        LetterGrid::read(rows.iter().copied(), (rows[0].len(), rows.len()), 1, ".@").expect("a rectangle")
    }

    #[test]
    fn a_corridor_is_never_cut() {
        let g = grid("..@..\n@...@\n..@..");
        let mut floor = g.which(".");
        let places = g.take_places(&mut floor, &g.which("."), 99);
        assert!(!places[7], "the middle joins both halves");
    }

    #[test]
    fn what_is_not_open_becomes_few_rectangles() {
        let g = grid("@@.@\n@@.@\n....\n@@..");
        let options = Options::default();
        let mut draft = g.draft(&options);
        g.add_outlines(&mut draft, &g.which("."), &options);
        let corners = |o: &Vec<Point>| (o[0].x, o[0].y, o[2].x, o[2].y);
        assert_eq!(draft.walkable.iter().map(corners).collect::<Vec<_>>(), [(-0.5, -0.5, 3.5, 3.5)]);
        let expected = [(-0.5, 1.5, 1.5, 3.5), (2.5, 1.5, 3.5, 3.5), (-0.5, -0.5, 1.5, 0.5)];
        assert_eq!(draft.obstacles.iter().map(corners).collect::<Vec<_>>(), expected);
    }

    #[test]
    fn bad_rows_are_refused_with_their_line() {
        let read = |rows: &[&str]| LetterGrid::read(rows.iter().copied(), (2, 2), 5, ".@").err();
        assert_eq!(read(&["..", ".x"]), Some(MapError::syntax(6, 2, "cells must be one of \".@\"")));
        assert_eq!(read(&["..", "..."]), Some(MapError::syntax(6, 0, "3 cells in a row, the header says 2")));
        assert_eq!(read(&[".."]), Some(MapError::syntax(6, 0, "1 rows, the header says 2")));
        assert_eq!(read(&["..", "..", ".."]), Some(MapError::syntax(7, 0, "3 rows, the header says 2")));
        assert_eq!(read(&["..", "..", "", " "]), None);
    }

    proptest! {
        #[test]
        fn taking_places_leaves_the_floor_connected_and_every_place_beside_it(
            cells in prop::collection::vec(prop::bool::weighted(0.8), 12 * 9),
            most in 0usize..80,
            more: bool,
        ) {
            let cells = cells.into_iter().map(|free| if free { b'.' } else { b'@' }).collect();
            let g = LetterGrid { width: 12, height: 9, cells };
            let mut floor = g.which(".");
            g.keep_largest_part(&mut floor);
            let mut places = g.take_places(&mut floor, &g.which("."), most);
            prop_assert!(places.iter().filter(|p| **p).count() <= most);
            if more {
                g.take_more_places(&mut floor, &g.which("."), &mut places, usize::MAX);
            }
            prop_assert_eq!(g.keep_largest_part(&mut floor.clone()), 0);
            for c in (0..places.len()).filter(|&c| places[c]) {
                prop_assert!(g.around(c).any(|n| floor[n]));
            }
        }
    }
}
