//! A map as a drawing: floor, lanes, places, with title, scale and legend.
//!
//! Main function: [`to_svg`]. Names are drawn if there are few nodes; stations always have theirs. A refused map is
//! drawn without its bad parts, with its errors in red. Refuses: robots and people; a drawing shows the building only.

mod canvas;
mod marks;

use super::check::{Remark, Review, Severity};
use super::walkway::Walkways;
use super::{Lane, MapSummary, Node, NodeKind, Users, Warehouse, summary};
use crate::id::NodeId;
use canvas::{Canvas, MARGIN, escape};
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// Size of one entry of the legend, pixels.
const ENTRY: (f64, f64) = (184.0, 28.0);
/// Number of nodes below which a map shows all names.
const NAMED_BELOW: usize = 120;

const STYLE: &str = "
text{font-family:'Inter','Helvetica Neue',Arial,'DejaVu Sans',sans-serif;fill:#273142}
.title{font-size:22px;font-weight:600}.sub{font-size:13px;fill:#667085}.key{font-size:13px}
.name{fill:#344054;paint-order:stroke;stroke-width:3px;stroke-linejoin:round}
.on{text-anchor:middle;fill:#fff;font-weight:600}
.floor{fill:#fff;stroke:#d5dbe3}.block{fill:#eef1f5;stroke:#dfe4ea}
.lane{fill:none;stroke:#c2cad5}.under{fill:none;stroke:#b4c7bd;stroke-dasharray:2 3}
.foot{fill:none;stroke:#b79ae0;stroke-dasharray:1 4;stroke-linecap:round}
.arrow{fill:none;stroke:#7d8898;stroke-linecap:round;stroke-linejoin:round}
.walk{fill:none;stroke:#b26ad1;stroke-opacity:.55;stroke-linecap:round;stroke-linejoin:round}
.node{fill:#aab4c1}.scale{fill:none;stroke:#273142;stroke-width:1.5}";

/// Draws the map as a standalone SVG document.
pub fn to_svg(w: &Warehouse) -> String {
    draw(w, &[])
}

/// Draws a map with its errors in red, at their places and in words; nothing if no part of it can be drawn.
pub fn review_to_svg(review: &Review) -> Option<String> {
    let errors: Vec<&Remark> = review.of(Severity::Error).collect();
    Some(draw(review.warehouse.as_ref()?, &errors))
}

fn draw(w: &Warehouse, errors: &[&Remark]) -> String {
    let s = summary(w);
    let c = Canvas::around(w);
    let walks = Walkways::of(w);
    let entries = legend_entries(w, &s, !walks.edges().is_empty());
    let columns = ((c.width - 2.0 * MARGIN) / ENTRY.0).floor().max(1.0) as usize;
    let legend_end = c.legend_top() + entries.len().div_ceil(columns) as f64 * ENTRY.1;
    let height = legend_end + marks::height(&c, errors) + MARGIN * 0.6;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0} {height:.0}\" width=\"{0:.0}\" \
         height=\"{height:.0}\">\n<title>{1}</title>\n<style>{STYLE}\n</style>\n",
        c.width,
        escape(&w.name)
    );
    symbols(&mut out, &c);
    out.push_str("<rect width=\"100%\" height=\"100%\" fill=\"#f6f7f9\"/>\n");
    title(&mut out, &c, &s);
    outlines(&mut out, &c, w);
    lanes(&mut out, &c, w);
    walkways(&mut out, &c, &walks);
    places(&mut out, &c, w);
    names(&mut out, &c, w);
    legend(&mut out, &c, &entries, columns);
    marks::draw(&mut out, &c, errors, legend_end);
    out.push_str("</svg>\n");
    out
}

/// Appends formatted text; writing to a string never fails.
macro_rules! put {
    ($out:expr, $($arg:tt)*) => {
        write!($out, $($arg)*).expect("a string takes all text")
    };
}

/// One drawing per kind of place, one metre wide, its middle at zero.
fn symbols(out: &mut String, c: &Canvas) {
    let square = |side: f64, radius: f64, paint: &str| {
        format!(
            "<rect x=\"{0}\" y=\"{0}\" width=\"{side}\" height=\"{side}\" rx=\"{radius}\" {paint}/>",
            -side / 2.0
        )
    };
    let bolt = "<path d=\"M.06-.28-.16.05H0L-.06.28.16-.05H0Z\" fill=\"#fff\"/>";
    let letter = "<path d=\"M-.11.2V-.2H.03A.12.12 0 0 1 .03.05H-.11\" fill=\"none\" stroke=\"#667085\" \
                  stroke-width=\".075\"/>";
    let shelf = "<path d=\"M-.36-.12H.36M-.36.12H.36M0-.36V.36\" stroke=\"#4f9473\" stroke-width=\".035\"/>";
    let door = "<path d=\"M-.14.24V-.24H.14V.24M-.24.24H.24M.05 0V.03\" fill=\"none\" stroke=\"#fff\" \
                stroke-width=\".07\" stroke-linecap=\"round\"/>";
    let open = "fill=\"#fff\" stroke=\"#b9c2ce\" stroke-width=\".04\"";
    let kinds = [
        ("storage", square(0.78, 0.06, "fill=\"#fff\" stroke=\"#9db8aa\" stroke-width=\".04\"")),
        ("rack", square(0.78, 0.06, "fill=\"#8ccbab\" stroke=\"#4f9473\" stroke-width=\".04\"") + shelf),
        ("station", square(0.84, 0.16, "fill=\"#2563c9\"")),
        ("queue", square(0.7, 0.16, "fill=\"#dbe8fb\" stroke=\"#7ea8e8\" stroke-width=\".04\"")),
        ("charger", square(0.74, 0.16, "fill=\"#eda53b\"") + bolt),
        ("parking", square(0.74, 0.16, open) + letter),
        ("exit", square(0.74, 0.16, "fill=\"#8a5fcf\"") + door),
    ];
    out.push_str("<defs>\n");
    for (id, drawing) in kinds {
        put!(out, "<g id=\"{id}\"><g transform=\"scale({:.2})\">{drawing}</g></g>\n", c.scale);
    }
    out.push_str("</defs>\n");
}

fn title(out: &mut String, c: &Canvas, s: &MapSummary) {
    let sub = format!("{:.1} × {:.1} m · {} nodes · {} lanes", s.width_m, s.height_m, s.nodes, s.lanes);
    put!(out, "<text class=\"title\" x=\"{MARGIN}\" y=\"{}\">{}</text>\n", MARGIN + 18.0, escape(&s.name));
    put!(out, "<text class=\"sub\" x=\"{MARGIN}\" y=\"{}\">{sub}</text>\n", MARGIN + 40.0);
    let longest = (c.high.x - c.low.x) / 4.0;
    let nice = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1_000.0];
    let metres = nice.into_iter().rfind(|&m| m <= longest).unwrap_or(nice[0]);
    let (x, y, right) = (c.width - MARGIN - metres * c.scale, MARGIN + 34.0, c.width - MARGIN);
    put!(out, "<path class=\"scale\" d=\"M{x:.1} {}V{y}H{right:.1}V{}\"/>\n", y - 6.0, y - 6.0);
    let middle = (x + right) / 2.0;
    put!(
        out,
        "<text class=\"sub\" text-anchor=\"middle\" x=\"{middle:.1}\" y=\"{}\">{metres} m</text>\n",
        y - 9.0
    );
}

fn outlines(out: &mut String, c: &Canvas, w: &Warehouse) {
    for (class, shapes) in [("floor", &w.walkable), ("block", &w.obstacles)] {
        if shapes.is_empty() {
            continue;
        }
        put!(out, "<path class=\"{class}\" d=\"");
        for shape in shapes {
            for (i, p) in shape.iter().enumerate() {
                let (x, y) = c.px(*p);
                put!(out, "{}{x:.1} {y:.1}", if i == 0 { "M" } else { "L" });
            }
            out.push('Z');
        }
        out.push_str("\"/>\n");
    }
}

fn lanes(out: &mut String, c: &Canvas, w: &Warehouse) {
    let width = (c.scale * 0.05).clamp(0.5, 2.0);
    let (under, foot) = (|u: Users| !u.loaded && u.unloaded, |u: Users| u == Users::PEOPLE);
    let classes: [(&str, &dyn Fn(Users) -> bool); 3] =
        [("under", &under), ("foot", &foot), ("lane", &|u| !under(u) && !foot(u))];
    for (class, fits) in classes {
        put!(out, "<path class=\"{class}\" stroke-width=\"{width:.2}\" d=\"");
        for lane in w.lanes.iter().filter(|l| fits(l.users)) {
            let ((ax, ay), (bx, by)) = (c.px(w.nodes[lane.a].at), c.px(w.nodes[lane.b].at));
            put!(out, "M{ax:.1} {ay:.1}L{bx:.1} {by:.1}");
        }
        out.push_str("\"/>\n");
    }
    put!(out, "<path class=\"arrow\" stroke-width=\"{:.2}\" d=\"", width * 1.2);
    for lane in w.lanes.iter().filter(|l| !l.both) {
        arrow(out, c, w, lane);
    }
    out.push_str("\"/>\n");
    put!(out, "<g class=\"node\">");
    for node in w.nodes.iter().filter(|n| n.kind == NodeKind::Aisle) {
        let (x, y) = c.px(node.at);
        put!(out, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\"/>", (c.scale * 0.06).clamp(0.6, 4.0));
    }
    out.push_str("</g>\n");
}

/// The middle lines of the floor on which people walk.
fn walkways(out: &mut String, c: &Canvas, walks: &Walkways) {
    put!(out, "<path class=\"walk\" stroke-width=\"{:.2}\" d=\"", (c.scale * 0.04).clamp(0.6, 2.0));
    let mut pen = None;
    for e in walks.edges().ids() {
        let (edge, s) = (&walks.edges()[e], walks.segment(e));
        if pen != Some(edge.a) {
            let (x, y) = c.px(s.a);
            put!(out, "M{x:.1} {y:.1}");
        }
        let (x, y) = c.px(s.b);
        put!(out, "L{x:.1} {y:.1}");
        pen = Some(edge.b);
    }
    out.push_str("\"/>\n");
}

/// A chevron in the middle of a one-way lane.
fn arrow(out: &mut String, c: &Canvas, w: &Warehouse, lane: &Lane) {
    let ((ax, ay), (bx, by)) = (c.px(w.nodes[lane.a].at), c.px(w.nodes[lane.b].at));
    let length = (bx - ax).hypot(by - ay).max(1e-9);
    let size = (c.scale * 0.14).min(length * 0.3);
    let (ux, uy) = ((bx - ax) / length * size, (by - ay) / length * size);
    let (tx, ty) = ((ax + bx) / 2.0 + ux / 2.0, (ay + by) / 2.0 + uy / 2.0);
    let (lx, ly, rx, ry) = (tx - ux - uy * 0.7, ty - uy + ux * 0.7, tx - ux + uy * 0.7, ty - uy - ux * 0.7);
    put!(out, "M{lx:.1} {ly:.1}L{tx:.1} {ty:.1}L{rx:.1} {ry:.1}");
}

/// The nodes with a rack.
fn homes(w: &Warehouse) -> BTreeSet<NodeId> {
    w.racks.iter().map(|r| r.home).collect()
}

fn places(out: &mut String, c: &Canvas, w: &Warehouse) {
    let homes = homes(w);
    for (n, node) in w.nodes.pairs() {
        let symbol = match node.kind {
            NodeKind::Aisle => continue,
            NodeKind::Storage if homes.contains(&n) => "rack",
            NodeKind::Storage => "storage",
            NodeKind::Station(_) => "station",
            NodeKind::Queue(_) => "queue",
            NodeKind::Charger => "charger",
            NodeKind::Parking => "parking",
            NodeKind::Exit => "exit",
        };
        let (x, y) = c.px(node.at);
        put!(out, "<use href=\"#{symbol}\" x=\"{x:.1}\" y=\"{y:.1}\"/>\n");
    }
}

fn names(out: &mut String, c: &Canvas, w: &Warehouse) {
    for station in w.stations.iter() {
        let (x, y) = c.px(w.nodes[station.node].at);
        let size = c.scale * (1.1 / station.name.chars().count().max(2) as f64).min(0.4);
        let name = escape(&station.name);
        put!(
            out,
            "<text class=\"on\" font-size=\"{size:.1}\" x=\"{x:.1}\" y=\"{:.1}\">{name}</text>\n",
            y + size * 0.36
        );
    }
    if w.nodes.len() < NAMED_BELOW {
        let homes = homes(w);
        w.nodes.pairs().for_each(|(n, node)| name(out, c, node, homes.contains(&n)));
    }
}

/// Draws a node's name: inside storage and queue places, else below and to the right, clear of the lanes.
fn name(out: &mut String, c: &Canvas, node: &Node, has_rack: bool) {
    let (x, y) = c.px(node.at);
    let size = (c.scale * 0.17).min(11.0);
    let text = escape(&node.name);
    let (x, y, anchor, halo) = match node.kind {
        NodeKind::Station(_) => return,
        NodeKind::Storage if has_rack => (x, y + size * 0.36, "middle", "#8ccbab"),
        NodeKind::Storage => (x, y + size * 0.36, "middle", "#fff"),
        NodeKind::Queue(_) => (x, y + size * 0.36, "middle", "#dbe8fb"),
        NodeKind::Aisle => (x + size * 0.4, y + size * 1.2, "start", "#fff"),
        _ => (x, y + c.scale * 0.37 + size, "middle", "#f9fafb"),
    };
    put!(
        out,
        "<text class=\"name\" text-anchor=\"{anchor}\" stroke=\"{halo}\" font-size=\"{size:.1}\" x=\"{x:.1}\" \
         y=\"{y:.1}\">{text}</text>\n"
    );
}

/// The mark of a line of the legend: a symbol, or a lane of a class with or without an arrow.
enum LegendMark {
    Symbol(&'static str),
    Lane(&'static str, bool),
}

fn legend_entries(w: &Warehouse, s: &MapSummary, walks: bool) -> Vec<(LegendMark, String)> {
    let count = |fits: &dyn Fn(&Lane) -> bool| w.lanes.iter().filter(|l| fits(l)).count();
    let under = count(&|l| !l.users.loaded && l.users.unloaded);
    let foot = count(&|l| l.users == Users::PEOPLE);
    let entries = [
        (LegendMark::Symbol("rack"), "racks", s.racks),
        (LegendMark::Symbol("storage"), "free storage", s.storage - s.racks),
        (LegendMark::Symbol("station"), "stations", s.stations),
        (LegendMark::Symbol("queue"), "queue places", s.queue_places),
        (LegendMark::Symbol("charger"), "chargers", s.chargers),
        (LegendMark::Symbol("parking"), "parking places", s.parking),
        (LegendMark::Symbol("exit"), "doors for people", s.exits),
        (LegendMark::Lane("lane", true), "one-way lanes", s.one_way_lanes),
        (
            LegendMark::Lane("lane", false),
            "lanes both ways",
            count(&|l| l.both) - count(&|l| l.both && !l.users.loaded),
        ),
        (LegendMark::Lane("under", false), "unloaded only", under),
        (LegendMark::Lane("foot", false), "people only", foot),
    ];
    let shown = entries.into_iter().filter(|(_, _, count)| *count > 0);
    let counted = shown.map(|(mark, what, count)| (mark, format!("{what} · {count}")));
    let walks = walks.then(|| (LegendMark::Lane("walk", false), "walkways".to_string()));
    counted.chain(walks).collect()
}

fn legend(out: &mut String, c: &Canvas, entries: &[(LegendMark, String)], columns: usize) {
    for (i, (mark, text)) in entries.iter().enumerate() {
        let x = MARGIN + (i % columns) as f64 * ENTRY.0;
        let y = c.legend_top() + ((i / columns) as f64 + 0.5) * ENTRY.1;
        match mark {
            LegendMark::Symbol(id) => {
                let shrink = 22.0 / c.scale;
                let place = format!("translate({:.1} {y:.1}) scale({shrink:.3})", x + 12.0);
                put!(out, "<use href=\"#{id}\" transform=\"{place}\"/>\n");
            }
            LegendMark::Lane(class, arrow) => {
                put!(out, "<path class=\"{class}\" stroke-width=\"2\" d=\"M{x:.1} {y:.1}h24\"/>\n");
                if *arrow {
                    let tip = format!("M{:.1} {:.1}l5 4l-5 4", x + 10.0, y - 4.0);
                    put!(out, "<path class=\"arrow\" stroke-width=\"1.8\" d=\"{tip}\"/>\n");
                }
            }
        }
        put!(out, "<text class=\"key\" x=\"{:.1}\" y=\"{:.1}\">{text}</text>\n", x + 34.0, y + 4.5);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warehouse::{kiva, sketch};

    #[test]
    fn a_drawing_shows_every_place_and_escapes_names() {
        let mut draft = sketch("RS.C\n....\nP.1X");
        draft.name = "<Hall & more>".into();
        let svg = to_svg(&draft.build().expect("well-formed"));
        for symbol in ["rack", "storage", "station", "charger", "parking", "exit"] {
            let uses = svg.matches(&format!("<use href=\"#{symbol}\"")).count();
            assert_eq!(uses, 2, "one {symbol} on the floor, one in the legend");
        }
        assert!(svg.contains("&lt;Hall &amp; more&gt;") && !svg.contains("<Hall"));
        assert!(svg.contains(">2,1</text>"), "few nodes have names");
    }

    #[test]
    fn a_large_hall_is_drawn_without_names_of_nodes_but_with_those_of_stations() {
        let svg = to_svg(&kiva());
        assert!(!svg.contains(">A0-0</text>") && svg.contains(">W24</text>"));
        assert!(!svg.contains("NaN") && svg.len() < 1_500_000, "{} bytes", svg.len());
    }
}
