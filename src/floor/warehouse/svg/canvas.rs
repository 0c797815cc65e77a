//! From metres to pixels, and text escaped for SVG.
//!
//! Main type: [`Canvas`]. Refuses: to draw anything.

use crate::geometry::Point;
use crate::warehouse::Warehouse;

/// Approximate size of the floor's longer side, pixels.
const FLOOR_PX: f64 = 1_600.0;
/// Least width of a drawing, so that title and legend have room, pixels.
const WIDTH_MIN: f64 = 640.0;
/// Margin around everything, pixels.
pub(super) const MARGIN: f64 = 36.0;
/// Height of the title, pixels.
const TITLE: f64 = 76.0;

/// The mapping from metres to pixels.
pub(super) struct Canvas {
    /// Pixels per metre.
    pub scale: f64,
    /// Width of the drawing, pixels.
    pub width: f64,
    /// Room on the left of the floor, pixels.
    pub left: f64,
    /// Low corner of the area that is shown, metres.
    pub low: Point,
    /// High corner of the area that is shown, metres.
    pub high: Point,
}

impl Canvas {
    /// A canvas with room for all of a map.
    pub fn around(w: &Warehouse) -> Canvas {
        let (low, high) = w.bounds();
        let (low, high) = (Point::new(low.x - 0.5, low.y - 0.5), Point::new(high.x + 0.5, high.y + 0.5));
        let size = high - low;
        let scale = (FLOOR_PX / size.x.max(size.y)).clamp(0.5, 64.0);
        let width = (size.x * scale + 2.0 * MARGIN).max(WIDTH_MIN);
        Canvas { scale, width, left: (width - size.x * scale) / 2.0, low, high }
    }

    /// The pixel position of a place.
    pub fn px(&self, p: Point) -> (f64, f64) {
        (self.left + (p.x - self.low.x) * self.scale, MARGIN + TITLE + (self.high.y - p.y) * self.scale)
    }

    /// Where the text below the floor begins, pixels from the top.
    pub fn legend_top(&self) -> f64 {
        self.px(self.low).1 + MARGIN * 0.8
    }
}

/// Text with the special characters of SVG escaped.
pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
