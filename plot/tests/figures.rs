//! Figures of every kind: what is drawn, what is left out, and that the bytes are always the same.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_plot::{
    Axis, Band, Colour, Dash, Figure, HeatMap, HeatRow, Mark, Panel, Series, Theme, bitmap, png, svg,
};
use ndarray::{Array1, Array2, array};

fn wave() -> Figure {
    let time = Array1::linspace(0.0, 20.0, 20_000);
    let rate = time.mapv(|t: f64| (3.0 * t).sin());
    let curve = Series::of_signals("a < b & c", Colour::First, time.view(), rate.view());
    let marks = vec![
        Mark::Level { y: 0.5, text: "limit".to_owned() },
        Mark::Instant { x: 4.0, text: "\"start\"".to_owned() },
        Mark::Point { x: 5.0, y: 0.2, text: "worst".to_owned(), colour: Colour::Second },
    ];
    let band = Band::new("interval", Colour::Third, [(0.0, -0.2, 0.2), (20.0, -0.4, 0.4)]);
    let panel = Panel::new(Axis::linear("hub rate", "rad/s"), vec![curve]);
    Figure::new(
        "wave <1>",
        Axis::linear("time", "s"),
        vec![panel.with_marks(marks).with_bands(vec![band]), response()],
    )
}

fn response() -> Panel {
    let phase = (0..200).map(|k| (0.1 * f64::from(k), -1.8 * f64::from(k)));
    Panel::new(Axis::degrees("phase"), vec![Series::dashed_line("phase", Colour::Second, phase)])
        .with_height(120.0)
}

fn one_panel(axis: Axis, points: impl IntoIterator<Item = (f64, f64)>) -> Figure {
    let series = vec![Series::solid_line("s", Colour::Second, points)];
    Figure::new("figure", Axis::linear("x", ""), vec![Panel::new(axis, series)])
}

fn heat() -> Figure {
    let row =
        |name: &str, cover: Option<&str>| HeatRow { name: name.to_owned(), cover: cover.map(str::to_owned) };
    Figure::heat_map(
        "where",
        HeatMap {
            meaning: "share".to_owned(),
            frame_meaning: "found".to_owned(),
            heading: "components".to_owned(),
            columns: vec!["rate".to_owned(), "a < b".to_owned()],
            rows: vec![row("pivot", None), row("gyro", Some("not seen")), row("motor", None)],
            shares: array![[0.873, f64::NAN], [f64::NAN, f64::NAN], [7.0, -1.0]],
            framed: vec![(0, 1)],
        },
    )
}

/// Returns every kind of figure.
fn all() -> Vec<Figure> {
    vec![
        wave(),
        heat(),
        one_panel(Axis::linear("y", ""), []),
        Figure::new("none", Axis::linear("x", ""), vec![]),
    ]
}

/// Coordinates of the paths with a class.
fn paths(svg: &str, class: &str) -> Vec<Vec<Vec<(f64, f64)>>> {
    let lines =
        svg.lines().filter(|line| line.starts_with("<path") && line.contains(&format!("\"{class}\"")));
    let number = |text: &str| text.parse::<f64>().unwrap();
    let point = |text: &str| text.split_once(' ').map(|(x, y)| (number(x), number(y))).unwrap();
    lines
        .map(|line| {
            let path = line.split("d=\"").nth(1).unwrap().split('"').next().unwrap();
            path.split('M').skip(1).map(|run| run.split('L').map(point).collect()).collect()
        })
        .collect()
}

/// Checks what holds for the markup of every figure.
fn check_markup(svg: &str) {
    assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"), "{svg}");
    for word in ["NaN", "inf", "cannot be drawn"] {
        assert!(!svg.contains(word), "{word} in {svg}");
    }
    assert_eq!(svg.matches("<text").count(), svg.matches("</text>").count());
    assert_eq!(svg.matches('<').count(), svg.matches('>').count());
    for path in svg.split("d=\"").skip(1).map(|part| part.split('"').next().unwrap()) {
        assert!(path.starts_with('M'), "{path}");
        for number in path.split(['M', 'L', ' ']).filter(|text| !text.is_empty()) {
            let value: f64 = number.parse().unwrap();
            assert!((-1.0..=641.0).contains(&value), "{value} in {svg}");
        }
    }
}

#[test]
fn markup_is_well_formed_and_stays_inside_the_picture() {
    for figure in all() {
        check_markup(&svg::inline_svg(&figure));
        check_markup(&svg::standalone_svg(&figure, Theme::Dark));
    }
}

#[test]
fn text_is_escaped_and_a_long_series_gives_a_small_picture() {
    let drawn = svg::inline_svg(&wave());
    assert!(drawn.contains("a &lt; b &amp; c") && !drawn.contains("a < b"));
    assert!(drawn.contains("aria-label=\"wave &lt;1&gt;\"") && drawn.contains("&quot;start&quot;"));
    assert!(drawn.len() < 40_000, "{}", drawn.len());
}

#[test]
fn the_same_figure_gives_the_same_bytes() {
    for (one, other) in all().iter().zip(&all()) {
        assert_eq!(svg::inline_svg(one), svg::inline_svg(other));
        assert_eq!(svg::standalone_svg(one, Theme::Light), svg::standalone_svg(other, Theme::Light));
        assert_eq!(png(one, Theme::Light, 1.0).unwrap(), png(other, Theme::Light, 1.0).unwrap());
    }
}

#[test]
fn inline_pictures_have_classes_alone_and_documents_colours_alone() {
    let (inline, alone) = (svg::inline_svg(&wave()), svg::standalone_svg(&wave(), Theme::Dark));
    assert!(!inline.contains('#') && !inline.contains("stroke="), "{inline}");
    assert!(!alone.contains("class=") && !alone.contains("var("));
    assert!(alone.contains(&Theme::Dark.hex(counterpoise_plot::theme::Role::Curve(Colour::First))));
    assert!(
        !inline.contains(">wave") && alone.contains(">wave &lt;1&gt;</text>"),
        "a page writes the title itself"
    );
}

#[test]
fn the_style_has_a_rule_for_every_class() {
    let style = counterpoise_plot::css::style_sheet();
    for figure in all() {
        for class in
            svg::inline_svg(&figure).split("class=\"").skip(1).map(|part| part.split('"').next().unwrap())
        {
            assert!(style.contains(&format!(".{class}{{")), "{class}");
        }
    }
    assert_eq!(style.matches('{').count(), style.matches('}').count());
}

#[test]
fn values_that_cannot_be_drawn_break_the_curve() {
    let points =
        [(0.0, 1.0), (1.0, 2.0), (2.0, f64::NAN), (3.0, 2.0), (4.0, 1.0), (5.0, f64::INFINITY), (6.0, 3.0)];
    let drawn = svg::inline_svg(&one_panel(Axis::linear("y", ""), points));
    let runs = paths(&drawn, "curve2").pop().unwrap();
    assert_eq!(runs.iter().map(Vec::len).collect::<Vec<_>>(), [2, 2, 2], "{runs:?}");
    let zero = svg::inline_svg(&one_panel(
        Axis::logarithmic("y", ""),
        [(0.0, 1.0), (1.0, 2.0), (2.0, 0.0), (3.0, 1.0), (4.0, 5.0)],
    ));
    assert_eq!(paths(&zero, "curve2").pop().unwrap().len(), 2, "a logarithmic axis has no zero");
}

#[test]
fn no_data_give_empty_axes_and_a_single_point_is_seen() {
    let empty = svg::inline_svg(&one_panel(Axis::linear("y", ""), []));
    assert!(empty.contains("class=\"frame\"") && paths(&empty, "grid").len() == 1);
    assert_eq!(paths(&empty, "curve2").len(), 1, "the sample in the legend");
    let single = svg::inline_svg(&one_panel(Axis::linear("y", ""), [(3.0, 4.0)]));
    let dot = &paths(&single, "curve2")[1][0];
    assert!((dot[1].0 - dot[0].0 - 2.0).abs() < 0.25 && dot[0].1 == dot[1].1, "{dot:?}");
}

#[test]
fn huge_and_tiny_ranges_are_drawn() {
    let scales = [1e-300, 1e-13, 1e-6, 1.0, 1e9, 1e290];
    for scale in scales {
        for offset in [0.0, 1.0, 1e6] {
            let value = |k: f64| scale * (offset + k);
            let points = (0..10).map(|k| (value(f64::from(k)), value(f64::from(k + 1))));
            for axis in [Axis::linear("y", ""), Axis::logarithmic("y", ""), Axis::degrees("y")] {
                let drawn = svg::inline_svg(&one_panel(axis.clone(), points.clone()));
                check_markup(&drawn);
                let curve = &paths(&drawn, "curve2")[1][0];
                assert_eq!(curve.len(), 10, "{scale:e} {offset} {axis:?}");
                assert!(curve[0].1 - curve[9].1 > 150.0, "the curve fills its panel: {curve:?}");
            }
        }
    }
}

#[test]
fn a_fixed_range_cuts_curves_and_bands_at_its_ends() {
    let mut panel = Panel::new(
        Axis::linear("y", "").with_range(0.0, 1.0),
        vec![Series::dotted_line("s", Colour::First, [(0.0, -5.0), (1.0, 5.0), (2.0, 0.5)])],
    );
    panel.bands =
        vec![Band::new("b", Colour::Fourth, [(0.0, -3.0, 3.0), (2.0, f64::NAN, 1.0), (3.0, -1.0, 9.0)])];
    panel.marks = vec![Mark::Level { y: 2.0, text: String::new() }];
    let drawn = svg::inline_svg(&Figure::new("cut", Axis::linear("x", "").with_range(0.0, 2.0), vec![panel]));
    check_markup(&drawn);
    assert!(paths(&drawn, "guide").is_empty(), "a level outside the panel is not drawn");
    let frame = paths(&drawn, "frame").pop().unwrap().pop().unwrap();
    let edges = frame.iter().fold((f64::MAX, f64::MIN), |(low, high), p| (low.min(p.1), high.max(p.1)));
    for run in &paths(&drawn, "curve1-dotted")[1] {
        assert!(run.iter().all(|p| (edges.0..=edges.1).contains(&p.1)), "{run:?} {edges:?}");
    }
}

#[test]
fn a_legend_has_each_name_once_and_none_without_a_name() {
    let series = |name: &str, colour| Series::solid_line(name, colour, [(0.0, 0.0), (1.0, 1.0)]);
    let panel = |names: [&str; 2]| {
        Panel::new(
            Axis::linear("y", ""),
            vec![series(names[0], Colour::First), series(names[1], Colour::Second)],
        )
    };
    let figure = Figure::new("l", Axis::linear("x", ""), vec![panel(["one", "two"]), panel(["one", ""])]);
    let drawn = svg::inline_svg(&figure);
    assert_eq!(drawn.matches(">one<").count(), 1);
    assert_eq!(drawn.matches("<text class=\"text\"").count(), 2 + 2 + 1, "names, y axes, x axis: {drawn}");
}

#[test]
fn every_cell_has_its_number_and_what_is_not_known_has_none() {
    let drawn = svg::inline_svg(&heat());
    assert!(drawn.contains(">87</text>") && drawn.contains(">\u{2013}</text>"));
    assert!(drawn.contains(">100</text>") && drawn.contains(">0</text>"), "shares are limited to 0 .. 1");
    assert!(drawn.contains("a &lt; b") && drawn.contains(">100 %</text>"));
    assert_eq!(drawn.matches("fill-opacity=\"0.83\"").count(), 1, "{drawn}");
    assert!(drawn.contains("class=\"cover\"") && drawn.contains(">not seen</text>"));
    assert_eq!(drawn.matches("class=\"cell-frame\"").count(), 2, "the cell and the legend: {drawn}");
    let empty = HeatMap {
        meaning: String::new(),
        frame_meaning: String::new(),
        heading: String::new(),
        columns: Vec::new(),
        rows: Vec::new(),
        shares: Array2::zeros((0, 0)),
        framed: Vec::new(),
    };
    check_markup(&svg::inline_svg(&Figure::heat_map("empty", empty)));
}

/// Returns the colours of a decoded PNG.
fn decode_png(file: &[u8]) -> (u32, u32, Vec<u8>) {
    let mut reader = png_file(file);
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    (info.width, info.height, pixels)
}

fn png_file(file: &[u8]) -> ::png::Reader<std::io::Cursor<&[u8]>> {
    ::png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap()
}

#[test]
fn a_png_decodes_to_the_picture_that_was_drawn() {
    for theme in [Theme::Light, Theme::Dark] {
        for figure in all() {
            let (width, height, pixels) = decode_png(&png(&figure, theme, 1.0).unwrap());
            let drawn = bitmap(&figure, theme, 1.0).unwrap();
            assert_eq!((width as usize, height as usize, &pixels), (drawn.width, drawn.height, &drawn.rgb));
            assert_eq!(width, 640);
            let ground = theme.colour(counterpoise_plot::theme::Role::Panel);
            assert_eq!((pixels[0], pixels[1], pixels[2]), ground);
            let ink = pixels.chunks(3).filter(|p| (p[0], p[1], p[2]) != ground).count();
            assert!(ink > 100, "{ink} pixels are drawn");
        }
    }
    assert_eq!(decode_png(&png(&wave(), Theme::Light, 2.0).unwrap()).0, 1280);
    assert_eq!(decode_png(&png(&wave(), Theme::Light, f64::NAN).unwrap()).0, 640);
}

#[test]
fn a_curve_has_its_colour_in_a_bitmap() {
    let blue = Theme::Light.colour(counterpoise_plot::theme::Role::Curve(Colour::First));
    let figure = |dash| {
        let series = Series::new("", Colour::First, dash, [(0.0, 0.0), (1.0, 1.0)]);
        Figure::new("line", Axis::linear("x", ""), vec![Panel::new(Axis::linear("y", ""), vec![series])])
    };
    let count = |dash| {
        let drawn = bitmap(&figure(dash), Theme::Light, 3.0).unwrap();
        drawn.rgb.chunks(3).filter(|p| (p[0], p[1], p[2]) == blue).count()
    };
    let (solid, dashed, dotted) = (count(Dash::Solid), count(Dash::Dashed), count(Dash::Dotted));
    assert!(dotted > 0 && dotted < dashed && dashed < solid, "{dotted} {dashed} {solid}");
}
