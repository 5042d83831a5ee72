//! Plots with two logarithmic axes, as SVG and as pixels.

use crate::develop::{ADVANCE, dots};
use plotters::backend::{BitMapBackend, SVGBackend};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingErrorKind, FontTransform,
};

/// A line with its band.
#[derive(Clone, Debug, Default)]
pub struct Series {
    /// What the legend says.
    pub name: String,
    /// Selects colour and mark: the same thing has the same in all plots.
    pub number: usize,
    /// x, y, and the band's lower and upper end, in the order of x.
    pub points: Vec<[f64; 4]>,
    /// Points that are drawn hollow: those beyond what the reference can tell.
    pub hollow: Vec<bool>,
}

/// A plot. All values are above 0; letters are ASCII.
#[derive(Clone, Debug)]
pub struct Plot {
    /// Over the plot.
    pub title: String,
    /// Along x.
    pub x: String,
    /// Along y.
    pub y: String,
    /// The lines.
    pub series: Vec<Series>,
    /// A dashed line of this slope, through the first point of the first line, and its name.
    pub slope: Option<(f64, String)>,
    /// Whether points are marked.
    pub marks: bool,
}

/// Columns and rows.
pub const SIZE: (u32, u32) = (720, 480);

/// Colours that are told apart with any colour vision (Okabe & Ito 2008).
const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(60, 60, 60),
];

/// The plot as SVG.
///
/// # Errors
/// What the library says.
pub fn svg(plot: &Plot) -> Result<String, String> {
    let mut text = String::new();
    draw(
        plot,
        SVGBackend::with_string(&mut text, SIZE).into_drawing_area(),
    )?;
    Ok(text)
}

/// The plot as pixels, row by row.
///
/// # Errors
/// What the library says.
pub fn png(plot: &Plot) -> Result<Vec<[u8; 3]>, String> {
    let mut bytes = vec![0; (SIZE.0 * SIZE.1 * 3) as usize];
    let backend = Lettered(BitMapBackend::with_buffer(&mut bytes, SIZE));
    draw(plot, backend.into_drawing_area())?;
    Ok(bytes.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect())
}

/// The least and the greatest of `values`, a little apart.
fn range(values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
    let (low, high) = values
        .filter(|x| x.is_finite() && *x > 0.0)
        .fold((f64::INFINITY, 0.0f64), |(l, h), x| (l.min(x), h.max(x)));
    if low > high {
        return 0.1..10.0;
    }
    low / 1.5..high * 1.5
}

/// Parts of the plot's width and height that its legend takes, about: letters are 7 pixels wide, lines 16 high.
fn legend(plot: &Plot) -> [f64; 2] {
    let slope = plot.slope.iter().map(|(_, name)| name);
    let names = plot.series.iter().map(|s| &s.name).chain(slope);
    let lengths: Vec<usize> = names.map(|name| name.chars().count()).collect();
    let longest = lengths.iter().copied().max().unwrap_or(0);
    let width = (60 + 7 * longest) as f64 / f64::from(SIZE.0 - 104);
    let height = (20 + 16 * lengths.len()) as f64 / f64::from(SIZE.1 - 92);
    [width, height].map(|part| part.min(0.9))
}

/// The corner in which a legend hides least: of places along all lines, evenly in the plot's logarithms, the fewest are there. And how many are.
fn corner(
    plot: &Plot,
    x: &std::ops::Range<f64>,
    y: &std::ops::Range<f64>,
) -> (SeriesLabelPosition, usize) {
    const STEPS: u32 = 16;
    let part = legend(plot);
    let share = |v: f64, r: &std::ops::Range<f64>| (v / r.start).ln() / (r.end / r.start).ln();
    let mut places = Vec::new();
    for series in &plot.series {
        let at: Vec<[f64; 2]> = series
            .points
            .iter()
            .map(|p| [share(p[0], x), share(p[1], y)])
            .collect();
        places.extend(at.first());
        for pair in at.windows(2) {
            places.extend((1..=STEPS).map(|k| {
                let t = f64::from(k) / f64::from(STEPS);
                [0, 1].map(|i| pair[0][i] + t * (pair[1][i] - pair[0][i]))
            }));
        }
    }
    let hidden = |right: bool, upper: bool| {
        let near = |v: f64, far: bool, part: f64| if far { v > 1.0 - part } else { v < part };
        let there = |p: &&[f64; 2]| near(p[0], right, part[0]) && near(p[1], upper, part[1]);
        places.iter().filter(there).count()
    };
    // The first of equals: where lines fall, the upper right is what is looked at last.
    [
        (true, true, SeriesLabelPosition::UpperRight),
        (false, false, SeriesLabelPosition::LowerLeft),
        (false, true, SeriesLabelPosition::UpperLeft),
        (true, false, SeriesLabelPosition::LowerRight),
    ]
    .into_iter()
    .map(|(right, upper, position)| (position, hidden(right, upper)))
    .min_by_key(|&(_, hidden)| hidden)
    .unwrap_or((SeriesLabelPosition::UpperRight, 0))
}

/// 10^n, 2·10^n and 5·10^n; what else is in between has no room.
fn label(x: &f64) -> String {
    // A rounding error below 10^n is 10^n.
    let decade = (x.log10() + 1e-6).floor();
    let leading = (x / 10f64.powf(decade)).round();
    if ![1.0, 2.0, 5.0].contains(&leading) {
        return String::new();
    }
    let places = (-decade).max(0.0) as usize;
    match decade as i32 {
        -2..4 => format!("{x:.places$}"),
        decade => format!("{leading}e{decade}"),
    }
}

fn draw<B: DrawingBackend>(plot: &Plot, area: DrawingArea<B, Shift>) -> Result<(), String> {
    let failed = |e: DrawingAreaErrorKind<B::ErrorType>| e.to_string();
    area.fill(&WHITE).map_err(failed)?;
    let points = || plot.series.iter().flat_map(|s| &s.points);
    let x = range(points().map(|p| p[0]));
    let y = range(points().map(|p| p[1]));
    // Bands may be wider than anything; they don't set the scale by more than this.
    let bands = range(points().flat_map(|p| [p[2].max(y.start / 5.0), p[3].min(y.end * 5.0)]));
    let y = y.start.min(bands.start)..y.end.max(bands.end);
    let ends = [y.start, y.end];
    let clamp = |v: f64| v.clamp(ends[0], ends[1]);
    let (mut position, hidden) = corner(plot, &x, &y);
    let mut y = y;
    if hidden > 0 {
        // Where there is no room for the legend, it is made above all lines.
        position = SeriesLabelPosition::UpperRight;
        y.end = y.start * (y.end / y.start).powf(1.0 / (1.0 - legend(plot)[1]));
    }
    let mut chart = ChartBuilder::on(&area)
        .caption(&plot.title, ("sans-serif", 17))
        .margin(12)
        .margin_right(24)
        .x_label_area_size(44)
        .y_label_area_size(68)
        .build_cartesian_2d(x.clone().log_scale(), y.clone().log_scale())
        .map_err(failed)?;
    chart
        .configure_mesh()
        .x_desc(&plot.x)
        .y_desc(&plot.y)
        .label_style(("sans-serif", 13))
        .axis_desc_style(("sans-serif", 14))
        .x_label_formatter(&label)
        .y_label_formatter(&label)
        .bold_line_style(BLACK.mix(0.15))
        .light_line_style(BLACK.mix(0.05))
        .draw()
        .map_err(failed)?;
    for series in &plot.series {
        let color = COLORS[series.number % COLORS.len()];
        let upper = series.points.iter().map(|p| (p[0], clamp(p[3])));
        let lower = series.points.iter().rev().map(|p| (p[0], clamp(p[2])));
        let outline: Vec<_> = upper.chain(lower).collect();
        let band = Polygon::new(outline, color.mix(0.15).filled());
        chart.draw_series([band]).map_err(failed)?;
    }
    if let (Some((slope, name)), Some(from)) = (&plot.slope, points().next()) {
        let at = |x: f64| from[1] * (x / from[0]).powf(*slope);
        let steps = (0..=200).map(|i| x.start * (x.end / x.start).powf(f64::from(i) / 200.0));
        let line: Vec<_> = steps
            .map(|x| (x, at(x)))
            .filter(|p| y.contains(&p.1))
            .collect();
        let style = ShapeStyle::from(BLACK.mix(0.6)).stroke_width(1);
        chart
            .draw_series(DashedLineSeries::new(line, 6, 4, style))
            .map_err(failed)?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], BLACK.mix(0.6)));
    }
    for series in &plot.series {
        let (i, color) = (series.number, COLORS[series.number % COLORS.len()]);
        let line = series.points.iter().map(|p| (p[0], clamp(p[1])));
        chart
            .draw_series(LineSeries::new(
                line,
                ShapeStyle::from(color).stroke_width(2),
            ))
            .map_err(failed)?
            .label(&series.name)
            .legend(move |at| mark(i, at, color, false));
        if plot.marks {
            let marks = series.points.iter().zip(&series.hollow);
            let marks = marks.map(|(p, &hollow)| {
                EmptyElement::at((p[0], clamp(p[1]))) + mark(i, (0, 0), color, hollow)
            });
            chart.draw_series(marks).map_err(failed)?;
        }
    }
    chart
        .configure_series_labels()
        .position(position)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.2))
        .label_font(("sans-serif", 13))
        .draw()
        .map_err(failed)?;
    area.present().map_err(failed)
}

/// A polygon around a place: one with more corners for each line, so that no colour is needed to tell them apart.
fn mark(i: usize, (x, y): (i32, i32), color: RGBColor, hollow: bool) -> Polygon<(i32, i32)> {
    let corners = [16, 4, 3, 5, 6][i % 5];
    let ring = |radius: f64| {
        (0..=corners).map(move |k| {
            let angle = std::f64::consts::TAU * (f64::from(k) / f64::from(corners) - 0.25);
            let at = |c: i32, s: f64| c + (radius * s).round() as i32;
            (at(x, angle.cos()), at(y, angle.sin()))
        })
    };
    let outline: Vec<_> = if hollow {
        ring(5.0)
            .chain(ring(3.0).collect::<Vec<_>>().into_iter().rev())
            .collect()
    } else {
        ring(4.5).collect()
    };
    Polygon::new(outline, color.filled())
}

/// Pixels with letters of dots: no font file is needed, and every machine draws the same.
struct Lettered<'a>(BitMapBackend<'a>);

/// Pixels of a dot.
fn scale(size: f64) -> u32 {
    if size >= 16.0 { 2 } else { 1 }
}

impl DrawingBackend for Lettered<'_> {
    type ErrorType = <BitMapBackend<'static> as DrawingBackend>::ErrorType;

    fn get_size(&self) -> (u32, u32) {
        self.0.get_size()
    }
    fn ensure_prepared(&mut self) -> Result<(), DrawingErrorKind<Self::ErrorType>> {
        self.0.ensure_prepared()
    }
    fn present(&mut self) -> Result<(), DrawingErrorKind<Self::ErrorType>> {
        self.0.present()
    }
    fn draw_pixel(
        &mut self,
        point: BackendCoord,
        color: BackendColor,
    ) -> Result<(), DrawingErrorKind<Self::ErrorType>> {
        self.0.draw_pixel(point, color)
    }
    fn draw_line<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
    ) -> Result<(), DrawingErrorKind<Self::ErrorType>> {
        self.0.draw_line(from, to, style)
    }
    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Result<(), DrawingErrorKind<Self::ErrorType>> {
        self.0.draw_path(path, style)
    }
    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        outline: I,
        style: &S,
    ) -> Result<(), DrawingErrorKind<Self::ErrorType>> {
        self.0.fill_polygon(outline, style)
    }

    fn draw_text<S: BackendTextStyle>(
        &mut self,
        text: &str,
        style: &S,
        (x, y): BackendCoord,
    ) -> Result<(), DrawingErrorKind<Self::ErrorType>> {
        let k = scale(style.size());
        let (width, height) = self.estimate_text_size(text, style)?;
        let (width, height) = (width as i32, height as i32);
        let left = match style.anchor().h_pos {
            HPos::Left => 0,
            HPos::Center => -width / 2,
            HPos::Right => -width,
        };
        let top = match style.anchor().v_pos {
            VPos::Top => 0,
            VPos::Center => -height / 2,
            VPos::Bottom => -height,
        };
        let mut all = Vec::new();
        dots(text, |column, row| {
            for (i, j) in (0..k * k).map(|n| (n % k, n / k)) {
                let (u, v) = (left + (column * k + i) as i32, top + (row * k + j) as i32);
                all.push(match style.transform() {
                    FontTransform::Rotate90 => (x - v, y + u),
                    FontTransform::Rotate180 => (x - u, y - v),
                    FontTransform::Rotate270 => (x + v, y - u),
                    _ => (x + u, y + v),
                });
            }
        });
        for at in all {
            self.0.draw_pixel(at, style.color())?;
        }
        Ok(())
    }

    fn estimate_text_size<S: BackendTextStyle>(
        &self,
        text: &str,
        style: &S,
    ) -> Result<(u32, u32), DrawingErrorKind<Self::ErrorType>> {
        let k = scale(style.size());
        Ok((text.chars().count() as u32 * ADVANCE * k, 9 * k))
    }
}

#[cfg(test)]
mod tests {
    use super::label;

    #[test]
    fn ticks_have_short_labels() {
        for (x, text) in [
            (0.2000000000004, "0.2"),
            (0.09999999999, "0.1"),
            (0.7, ""),
            (1e-5, "1e-5"),
            (2e-3, "2e-3"),
            (0.05, "0.05"),
            (50.0, "50"),
            (2000.0, "2000"),
            (1e4, "1e4"),
        ] {
            assert_eq!(label(&x), text, "{x}");
        }
    }
}
