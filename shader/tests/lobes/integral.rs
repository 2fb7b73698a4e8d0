//! Integrals over rectangles, refined where they are not smooth.

/// Gauss and Legendre's five places in [-1, 1] and their weights.
const PLACES: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189),
    (-0.538_469_310_105_683, 0.478_628_670_499_366),
    (0.0, 0.568_888_888_888_889),
    (0.538_469_310_105_683, 0.478_628_670_499_366),
    (0.906_179_845_938_664, 0.236_926_885_056_189),
];

/// A rectangle: least and greatest of both coordinates.
#[derive(Clone, Copy)]
pub struct Rectangle(pub [f64; 2], pub [f64; 2]);

impl Rectangle {
    fn quarters(self) -> [Rectangle; 4] {
        let Rectangle([a, b], [c, d]) = self;
        let (x, y) = ((a + b) / 2.0, (c + d) / 2.0);
        [Rectangle([a, x], [c, y]), Rectangle([x, b], [c, y]), Rectangle([a, x], [y, d]), Rectangle([x, b], [y, d])]
    }

    fn sum(self, f: &impl Fn(f64, f64) -> f64) -> f64 {
        let Rectangle([a, b], [c, d]) = self;
        let at = |low: f64, high: f64, place: f64| (low + high + place * (high - low)) / 2.0;
        let row = |y: f64| PLACES.iter().map(|&(x, weight)| weight * f(at(a, b, x), y)).sum::<f64>();
        let rows: f64 = PLACES.iter().map(|&(y, weight)| weight * row(at(c, d, y))).sum();
        rows * (b - a) * (d - c) / 4.0
    }

    /// The integral of a function, within about so much.
    pub fn integral(self, f: &impl Fn(f64, f64) -> f64, error: f64) -> f64 {
        self.refined(self.sum(f), f, error, 8)
    }

    fn refined(self, whole: f64, f: &impl Fn(f64, f64) -> f64, error: f64, depth: u32) -> f64 {
        let parts = self.quarters().map(|part| (part, part.sum(f)));
        let sum: f64 = parts.iter().map(|part| part.1).sum();
        if depth == 0 || (sum - whole).abs() < error {
            return sum;
        }
        parts.iter().map(|&(part, of)| part.refined(of, f, error / 2.0, depth - 1)).sum()
    }
}
