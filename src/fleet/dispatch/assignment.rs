//! The assignment problem: rows to columns at the least sum of costs.
//!
//! Main function: [`least_cost`] (Hungarian method with potentials, after Jonker and Volgenant; O(rows² · columns)).
//! Refuses: floats, so that ties and order never depend on rounding.

/// A cost that means "never".
pub(crate) const NEVER: i64 = 1 << 50;

/// For each row the column assigned to it. `cost[r][c]`; there must be at least as many columns as rows. Pairs that
/// cost [`NEVER`] are left out of the result.
pub(crate) fn least_cost(cost: &[Vec<i64>]) -> Vec<Option<usize>> {
    let rows = cost.len();
    let columns = cost.first().map_or(0, Vec::len);
    assert!(rows <= columns, "pad with columns that cost NEVER");
    let mut row_price = vec![0i64; rows + 1];
    let mut column_price = vec![0i64; columns + 1];
    let mut owner = vec![0usize; columns + 1];
    let mut way = vec![0usize; columns + 1];
    for row in 1..=rows {
        owner[0] = row;
        let mut column = 0;
        let mut slack = vec![i64::MAX; columns + 1];
        let mut used = vec![false; columns + 1];
        while owner[column] != 0 {
            used[column] = true;
            let r = owner[column];
            let (mut delta, mut next) = (i64::MAX, 0);
            for c in 1..=columns {
                if used[c] {
                    continue;
                }
                let reduced = cost[r - 1][c - 1] - row_price[r] - column_price[c];
                if reduced < slack[c] {
                    (slack[c], way[c]) = (reduced, column);
                }
                if slack[c] < delta {
                    (delta, next) = (slack[c], c);
                }
            }
            for c in 0..=columns {
                if used[c] {
                    row_price[owner[c]] += delta;
                    column_price[c] -= delta;
                } else if slack[c] != i64::MAX {
                    slack[c] -= delta;
                }
            }
            column = next;
        }
        while column != 0 {
            owner[column] = owner[way[column]];
            column = way[column];
        }
    }
    let mut result = vec![None; rows];
    for c in 1..=columns {
        if owner[c] != 0 && cost[owner[c] - 1][c - 1] < NEVER {
            result[owner[c] - 1] = Some(c - 1);
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sum(cost: &[Vec<i64>], chosen: &[usize]) -> i64 {
        chosen.iter().enumerate().map(|(r, c)| cost[r][*c]).sum()
    }

    fn brute(cost: &[Vec<i64>], row: usize, chosen: &mut Vec<usize>) -> i64 {
        if row == cost.len() {
            return sum(cost, chosen);
        }
        let mut best = i64::MAX;
        for c in 0..cost[0].len() {
            if !chosen.contains(&c) {
                chosen.push(c);
                best = best.min(brute(cost, row + 1, chosen));
                chosen.pop();
            }
        }
        best
    }

    proptest! {
        #[test]
        fn no_other_assignment_is_cheaper(
            cost in (1usize..5).prop_flat_map(|r| {
                proptest::collection::vec(proptest::collection::vec(0i64..50, 5), r)
            }),
        ) {
            let chosen: Vec<usize> = least_cost(&cost).into_iter().map(|c| c.unwrap()).collect();
            prop_assert_eq!(sum(&cost, &chosen), brute(&cost, 0, &mut Vec::new()));
        }
    }

    #[test]
    fn a_pair_that_must_not_be_is_left_out() {
        assert_eq!(least_cost(&[vec![NEVER, 3], vec![NEVER, 1]]), vec![None, Some(1)]);
    }
}
