//! Pareto fronts.

/// Which of the (time, error) pairs no other one beats: with less of the one and no more of the other. By
/// growing time and so by falling error; of equal pairs the first. Numbers must not be NaN.
pub fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut by_time: Vec<usize> = (0..points.len()).collect();
    by_time.sort_by(|&a, &b| {
        let ((time_a, error_a), (time_b, error_b)) = (points[a], points[b]);
        time_a.total_cmp(&time_b).then(error_a.total_cmp(&error_b))
    });
    let mut least = None;
    by_time.retain(|&i| {
        let error = points[i].1;
        let better = least.is_none_or(|least| error < least);
        if better {
            least = Some(error);
        }
        better
    });
    by_time
}
