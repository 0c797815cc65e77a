//! Charts as standalone SVG documents.
//!
//! Main types: [`LineChart`], [`BarChart`]. Refuses: to compute the figures it draws.

use std::fmt::Write as _;

/// Width of a chart, pixels.
const WIDTH: f64 = 960.0;
/// Margins left and right of the plot, pixels.
const SIDES: (f64, f64) = (64.0, 24.0);
/// Height of the title, pixels.
const TITLE: f64 = 88.0;
/// Height of the plot itself, pixels.
const PLOT: f64 = 320.0;
/// Width of an entry of the legend and height of its line, pixels.
const ENTRY: (f64, f64) = (168.0, 22.0);

const STYLE: &str = "
text{font-family:'Inter','Helvetica Neue',Arial,'DejaVu Sans',sans-serif;font-size:13px;fill:#273142}
.title{font-size:19px;font-weight:600}.sub,.tick{fill:#667085}.tick{font-size:12px}
.grid{stroke:#e4e8ee}.axis{stroke:#667085}.mark{stroke:#98a2b3;stroke-dasharray:3 3}
.number{font-size:11px;font-weight:600;fill:#fff;text-anchor:middle}
.line{fill:none;stroke-width:2.2;stroke-linejoin:round}
.whisker{stroke:#273142;stroke-width:1.4;fill:none}";

/// Appends formatted text; writing to a string never fails.
macro_rules! put {
    ($out:expr, $($arg:tt)*) => {
        write!($out, $($arg)*).expect("a string takes all text")
    };
}

/// A line of a chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// The line's name in the legend.
    pub label: String,
    /// Colour as CSS writes it.
    pub colour: &'static str,
    /// Points in the order of x.
    pub points: Vec<(f64, f64)>,
}

/// Lines over a common axis, with numbered marks that are explained below.
#[derive(Clone, Debug, PartialEq)]
pub struct LineChart {
    /// Title of the chart.
    pub title: String,
    /// Text below the title.
    pub subtitle: String,
    /// Name of the horizontal axis with its unit.
    pub x: String,
    /// Name of the vertical axis with its unit.
    pub y: String,
    /// Lowest and highest value drawn.
    pub range: (f64, f64),
    /// The lines.
    pub series: Vec<Series>,
    /// Events on the horizontal axis, with their texts.
    pub marks: Vec<(f64, String)>,
}

/// A bar with the ends of its error bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    /// Height of the bar.
    pub value: f64,
    /// Lower end of the error bar.
    pub low: f64,
    /// Upper end of the error bar.
    pub high: f64,
}

/// Bars in groups, one of each series in a group.
#[derive(Clone, Debug, PartialEq)]
pub struct BarChart {
    /// Title of the chart.
    pub title: String,
    /// Text below the title, which also explains the error bars.
    pub subtitle: String,
    /// Name of the vertical axis with its unit.
    pub y: String,
    /// Names of the groups.
    pub groups: Vec<String>,
    /// Name, colour and one bar per group.
    pub series: Vec<(String, &'static str, Vec<Bar>)>,
}

/// The part of the picture inside the axes.
struct PlotFrame {
    x: (f64, f64),
    y: (f64, f64),
}

impl PlotFrame {
    fn px(&self, x: f64, y: f64) -> (f64, f64) {
        let (left, right) = (SIDES.0, WIDTH - SIDES.1);
        let across = (x - self.x.0) / (self.x.1 - self.x.0);
        let up = (y - self.y.0) / (self.y.1 - self.y.0);
        (left + across * (right - left), TITLE + (1.0 - up.clamp(0.0, 1.0)) * PLOT)
    }
}

/// Round numbers from `low` to `high`, about `about` of them.
fn ticks(low: f64, high: f64, about: f64) -> Vec<f64> {
    let rough = ((high - low) / about).max(1e-9);
    let scale = 10_f64.powf(rough.log10().floor());
    let nice = [1.0, 2.0, 2.5, 5.0, 10.0].into_iter().map(|s| s * scale);
    let step = nice.into_iter().find(|s| *s >= rough * 0.999).unwrap_or(10.0 * scale);
    let first = (low / step).ceil() as i64;
    (first..).map(|k| k as f64 * step).take_while(|t| *t <= high + step * 1e-6).collect()
}

fn number(v: f64) -> String {
    let text = format!("{v:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

fn head(out: &mut String, height: f64, title: &str, subtitle: &str) {
    put!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height:.0}\" width=\"{WIDTH}\" \
         height=\"{height:.0}\">\n<title>{0}</title>\n<style>{STYLE}\n</style>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
         <text class=\"title\" x=\"20\" y=\"30\">{0}</text>\n<text class=\"sub\" x=\"20\" y=\"50\">{1}</text>\n",
        escape(title),
        escape(subtitle)
    );
}

/// Grid lines and numbers of the vertical axis, and its name.
fn vertical(out: &mut String, frame: &PlotFrame, name: &str) {
    for t in ticks(frame.y.0, frame.y.1, 5.0) {
        let (x, y) = frame.px(frame.x.0, t);
        put!(out, "<path class=\"grid\" d=\"M{x:.1} {y:.1}H{:.1}\"/>", WIDTH - SIDES.1);
        put!(
            out,
            "<text class=\"tick\" text-anchor=\"end\" x=\"{:.1}\" y=\"{:.1}\">{}</text>\n",
            x - 8.0,
            y + 4.0,
            number(t)
        );
    }
    let middle = TITLE + PLOT / 2.0;
    put!(
        out,
        "<text class=\"sub\" text-anchor=\"middle\" transform=\"translate(18 {middle:.1}) rotate(-90)\">{}</text>\n",
        escape(name)
    );
}

/// The horizontal line at the bottom, with the name of the axis.
fn bottom(out: &mut String, name: &str) {
    let y = TITLE + PLOT;
    put!(out, "<path class=\"axis\" d=\"M{:.1} {y:.1}H{:.1}\"/>\n", SIDES.0, WIDTH - SIDES.1);
    let middle = (SIDES.0 + WIDTH - SIDES.1) / 2.0;
    put!(
        out,
        "<text class=\"sub\" text-anchor=\"middle\" x=\"{middle:.1}\" y=\"{:.1}\">{}</text>\n",
        y + 38.0,
        escape(name)
    );
}

/// Names with their colours from `top` on; returns the lower end.
fn legend(out: &mut String, top: f64, entries: &[(&str, &str)]) -> f64 {
    let columns = ((WIDTH - SIDES.0) / ENTRY.0).floor() as usize;
    for (i, (label, colour)) in entries.iter().enumerate() {
        let (x, y) = (SIDES.0 + (i % columns) as f64 * ENTRY.0, top + (i / columns) as f64 * ENTRY.1);
        put!(
            out,
            "<rect x=\"{x:.1}\" y=\"{:.1}\" width=\"18\" height=\"5\" rx=\"2\" fill=\"{colour}\"/>",
            y - 7.0
        );
        put!(out, "<text x=\"{:.1}\" y=\"{y:.1}\">{}</text>\n", x + 25.0, escape(label));
    }
    top + entries.len().div_ceil(columns) as f64 * ENTRY.1
}

impl LineChart {
    /// The chart as SVG.
    pub fn to_svg(&self) -> String {
        let all = || self.series.iter().flat_map(|s| &s.points);
        let (low, high) = all().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p.0), h.max(p.0)));
        let x = if low < high { (low, high) } else { (0.0, 1.0) };
        let frame = PlotFrame { x, y: self.range };
        let mut body = String::new();
        vertical(&mut body, &frame, &self.y);
        for t in ticks(x.0, x.1, 12.0) {
            let (px, py) = frame.px(t, self.range.0);
            put!(body, "<path class=\"axis\" d=\"M{px:.1} {py:.1}v5\"/>");
            let text = number(t);
            put!(
                body,
                "<text class=\"tick\" text-anchor=\"middle\" x=\"{px:.1}\" y=\"{:.1}\">{text}</text>\n",
                py + 19.0
            );
        }
        for (i, (at, _)) in self.marks.iter().enumerate() {
            let ((px, top), (_, low)) = (frame.px(*at, self.range.1), frame.px(*at, self.range.0));
            put!(body, "<path class=\"mark\" d=\"M{px:.1} {top:.1}V{low:.1}\"/>");
            badge(&mut body, px, top - 12.0, i);
        }
        for s in &self.series {
            let points: Vec<String> = (s.points.iter())
                .map(|p| frame.px(p.0, p.1))
                .map(|(x, y)| format!("{x:.1} {y:.1}"))
                .collect();
            put!(body, "<path class=\"line\" stroke=\"{}\" d=\"M{}\"/>\n", s.colour, points.join("L"));
        }
        bottom(&mut body, &self.x);
        let entries: Vec<(&str, &str)> = self.series.iter().map(|s| (s.label.as_str(), s.colour)).collect();
        let mut y = legend(&mut body, TITLE + PLOT + 66.0, &entries) + 8.0;
        for (i, (_, text)) in self.marks.iter().enumerate() {
            badge(&mut body, SIDES.0 + 9.0, y - 4.0, i);
            put!(body, "<text x=\"{:.1}\" y=\"{y:.1}\">{}</text>\n", SIDES.0 + 25.0, escape(text));
            y += ENTRY.1;
        }
        let mut out = String::new();
        head(&mut out, y, &self.title, &self.subtitle);
        out + &body + "</svg>\n"
    }
}

/// Draws the number of a mark in a disc.
fn badge(out: &mut String, x: f64, y: f64, i: usize) {
    put!(out, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"8\" fill=\"#667085\"/>");
    put!(out, "<text class=\"number\" x=\"{x:.1}\" y=\"{:.1}\">{}</text>\n", y + 4.0, i + 1);
}

impl BarChart {
    /// The chart as SVG.
    pub fn to_svg(&self) -> String {
        let bars = || self.series.iter().flat_map(|s| &s.2);
        let high = bars().map(|b| b.value.max(b.high)).fold(0.0, f64::max);
        let low = bars().map(|b| b.value.min(b.low)).fold(0.0, f64::min);
        let groups = self.groups.len().max(1) as f64;
        let room = if high > low { (high - low) * 0.05 } else { 1.0 };
        let frame = PlotFrame { x: (0.0, groups), y: (low, high + room) };
        let mut body = String::new();
        vertical(&mut body, &frame, &self.y);
        let wide = 0.8 / self.series.len().max(1) as f64;
        for (k, (_, colour, bars)) in self.series.iter().enumerate() {
            for (g, bar) in bars.iter().enumerate() {
                let from = g as f64 + 0.1 + k as f64 * wide;
                let ((left, top), (right, zero)) =
                    (frame.px(from, bar.value), frame.px(from + wide * 0.92, 0.0));
                put!(
                    body,
                    "<rect x=\"{left:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"{colour}\"/>",
                    top.min(zero),
                    right - left,
                    (zero - top).abs()
                );
                let ((middle, low), (_, high)) =
                    (frame.px(from + wide * 0.46, bar.low), frame.px(0.0, bar.high));
                put!(
                    body,
                    "<path class=\"whisker\" d=\"M{middle:.1} {low:.1}V{high:.1}M{0:.1} {low:.1}h8M{0:.1} \
                     {high:.1}h8\"/>\n",
                    middle - 4.0
                );
            }
        }
        for (g, name) in self.groups.iter().enumerate() {
            let (x, y) = frame.px(g as f64 + 0.5, low);
            put!(
                body,
                "<text text-anchor=\"middle\" x=\"{x:.1}\" y=\"{:.1}\">{}</text>\n",
                y + 20.0,
                escape(name)
            );
        }
        bottom(&mut body, "");
        let entries: Vec<(&str, &str)> = self.series.iter().map(|s| (s.0.as_str(), s.1)).collect();
        let y = legend(&mut body, TITLE + PLOT + 54.0, &entries);
        let mut out = String::new();
        head(&mut out, y, &self.title, &self.subtitle);
        out + &body + "</svg>\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_within_the_range() {
        assert_eq!(ticks(0.0, 1.0, 5.0), [0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0]);
        assert_eq!(ticks(0.0, 36.0, 12.0), [0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0]);
        assert_eq!(ticks(-0.3, 0.3, 3.0), [-0.2, 0.0, 0.2]);
        assert_eq!(
            (number(0.6000000000000001), number(-0.0), number(40.0)),
            ("0.6".into(), "0".into(), "40".into())
        );
    }

    #[test]
    fn a_line_chart_has_all_its_lines_marks_and_names() {
        let line = |label: &str| Series {
            label: label.into(),
            colour: "#123456",
            points: vec![(0.0, 0.1), (1.0, 0.9)],
        };
        let chart = LineChart {
            title: "A & B".into(),
            subtitle: "<none>".into(),
            x: "seconds".into(),
            y: "probability".into(),
            range: (0.0, 1.0),
            series: vec![line("one"), line("two")],
            marks: vec![(0.5, "half".into())],
        };
        let svg = chart.to_svg();
        assert_eq!(svg.matches("class=\"line\"").count(), 2);
        for text in ["A &amp; B", "&lt;none&gt;", ">one<", ">two<", ">half<", ">seconds<", ">probability<"] {
            assert!(svg.contains(text), "{text}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn bars_stand_on_zero_also_where_some_are_negative() {
        let bar = |value: f64| Bar { value, low: value - 1.0, high: value + 1.0 };
        let chart = BarChart {
            title: "t".into(),
            subtitle: String::new(),
            y: "m".into(),
            groups: vec!["a".into(), "b".into()],
            series: vec![
                ("x".into(), "#111", vec![bar(4.0), bar(-2.0)]),
                ("y".into(), "#222", vec![bar(1.0), bar(0.0)]),
            ],
        };
        let svg = chart.to_svg();
        assert_eq!((svg.matches("fill=\"#111\"").count(), svg.matches("class=\"whisker\"").count()), (3, 4));
        assert!(!svg.contains("NaN") && !svg.contains("height=\"-"));
    }
}
