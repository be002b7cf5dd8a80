//! Which intervals are divided where a verification fails.

/// The intervals that together make this part of what fails are divided.
const BLAMED: f64 = 0.9;

/// The intervals that make most of what fails, those with the most of it first; all where none has any.
pub(crate) fn blamed(blame: &[f64]) -> Vec<bool> {
    let all: f64 = blame.iter().sum();
    let mut order: Vec<usize> = (0..blame.len()).collect();
    order.sort_by(|a, b| blame[*b].total_cmp(&blame[*a]));
    let (mut marked, mut sum) = (vec![false; blame.len()], 0.0);
    for k in order {
        if sum >= BLAMED * all && all > 0.0 {
            break;
        }
        (marked[k], sum) = (true, sum + blame[k]);
    }
    marked
}

#[cfg(test)]
mod tests {
    use super::blamed;

    #[test]
    fn most_of_the_blame_is_divided() {
        assert_eq!(blamed(&[1.0, 0.0, 85.0, 5.0, 9.0]), [false, false, true, false, true]);
        assert_eq!(blamed(&[0.0, 0.0]), [true, true]);
        assert_eq!(blamed(&[1.0, f64::INFINITY, 2.0]), [false, true, false]);
    }
}
