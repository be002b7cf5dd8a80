use super::read;

/// A unit square in the plane z = 0 of a geometry, whose corners have positions and normals.
const SQUARE: &str = r##"<library_geometries><geometry id="square"><mesh>
<source id="at"><float_array id="numbers" count="12">0 0 0  1 0 0  1 1 0  0 1 0</float_array>
<technique_common><accessor source="#numbers" count="4" stride="3"/></technique_common></source>
<vertices id="corners"><input semantic="POSITION" source="#at"/></vertices>
PRIMITIVE</mesh></geometry></library_geometries>"##;
const TRIANGLES: &str = r##"<triangles count="2"><input semantic="VERTEX" source="#corners" offset="1"/>
<input semantic="NORMAL" source="#none" offset="0"/><p>9 0 9 1 9 2 9 0 9 2 9 3</p></triangles>"##;

fn file(asset: &str, primitive: &str, scene: &str) -> String {
    let geometries = SQUARE.replace("PRIMITIVE", primitive);
    format!(
        "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" \
         version=\"1.4.1\"><asset>{asset}</asset>{geometries}{scene}</COLLADA>"
    )
}

fn primitive(kind: &str, inner: &str) -> String {
    format!("<{kind}><input semantic=\"VERTEX\" source=\"#corners\" offset=\"0\"/>{inner}</{kind}>")
}

fn scene(nodes: &str) -> String {
    let all = format!(
        "<library_visual_scenes><visual_scene id=\"all\">{nodes}</visual_scene></library_visual_scenes>"
    );
    format!("{all}<scene><instance_visual_scene url=\"#all\"/></scene>")
}

const PLACED: &str = "<instance_geometry url=\"#square\"/>";

#[test]
fn all_primitives_give_the_same_square() {
    let expected = read(file("", TRIANGLES, "").as_bytes()).unwrap();
    assert_eq!((expected.vertices(), expected.triangles()), (4, 2));
    assert_eq!(expected.corners(), [[0.0; 3], [1.0, 1.0, 0.0]]);
    for (kind, inner) in [
        ("triangles", "<p>0 1 2 0 2 3</p>"),
        ("polylist", "<vcount>4</vcount><p>0 1 2 3</p>"),
        ("polygons", "<p>0 1 2 3</p>"),
        ("trifans", "<p>0 1 2 3</p>"),
    ] {
        assert_eq!(read(file("", &primitive(kind, inner), "").as_bytes()).unwrap(), expected, "{kind}");
    }
    let strip = read(file("", &primitive("tristrips", "<p>0 1 3 2</p>"), "").as_bytes()).unwrap();
    assert_eq!((strip.vertices(), strip.triangles()), (4, 2));
}

/// Millimetres; coordinates are those of the file whatever axis is up.
#[test]
fn units_count_and_the_axis_that_is_up_does_not() {
    let asset = "<unit name=\"millimeter\" meter=\"0.001\"/><up_axis>Y_UP</up_axis>";
    let mesh = read(file(asset, TRIANGLES, &scene(&format!("<node>{PLACED}</node>"))).as_bytes()).unwrap();
    assert_eq!(mesh.corners(), [[0.0; 3], [0.001, 0.001, 0.0]]);
}

#[test]
fn nodes_place_geometries() {
    let box_of = |nodes: &str| {
        let [low, high] = read(file("", TRIANGLES, &scene(nodes)).as_bytes()).unwrap().corners();
        [low, high].map(|corner| corner.map(|x| (1e4 * x).round() / 1e4))
    };
    // First scaled, then turned from x to y, then moved; inside of another node that moves by 10.
    let turned = format!(
        "<node><translate>0 0 10</translate><node><translate>5 0 0</translate><rotate>0 0 1 90</rotate>\
         <scale>2 1 1</scale>{PLACED}</node></node>"
    );
    assert_eq!(box_of(&turned), [[4.0, 0.0, 10.0], [5.0, 2.0, 10.0]]);
    let matrix = format!("<node><matrix>0 -1 0 5  2 0 0 0  0 0 1 10  0 0 0 1</matrix>{PLACED}</node>");
    assert_eq!(box_of(&matrix), box_of(&turned));
    let both = format!(
        "<node id=\"one\">{PLACED}</node><node><translate>0 0 3</translate><instance_node url=\"#one\"/></node>"
    );
    assert_eq!(box_of(&both), [[0.0; 3], [1.0, 1.0, 3.0]]);
    // A mirror turns the order of corners: the normal stays that of the mirrored surface.
    let mirrored = format!("<node><scale>-1 1 1</scale>{PLACED}</node>");
    let mesh = read(file("", TRIANGLES, &scene(&mirrored)).as_bytes()).unwrap();
    let [vertices, triangles] = mesh.bytes();
    let x = |of: usize| {
        let vertex = u32::from_le_bytes(triangles[4 * of..4 * of + 4].try_into().unwrap()) as usize;
        [0, 1].map(|k| f64::from(u16::from_le_bytes(vertices[6 * vertex + 2 * k..][..2].try_into().unwrap())))
    };
    let [a, b, c] = [x(0), x(1), x(2)];
    assert!((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0);
}

#[test]
fn what_is_wrong_is_told() {
    let endless = "<node id=\"a\"><instance_node url=\"#a\"/></node>";
    let many = (0..20).fold(format!("<node id=\"n0\">{PLACED}</node>"), |all, k| {
        format!(
            "{all}<node id=\"n{}\"><instance_node url=\"#n{k}\"/><instance_node url=\"#n{k}\"/></node>",
            k + 1
        )
    });
    for (text, words) in [
        ("<robot/>".to_owned(), "no COLLADA"),
        ("<COLLADA".to_owned(), "no COLLADA"),
        (file("<unit meter=\"0\"/>", TRIANGLES, ""), "unit"),
        (file("", "", ""), "no triangle"),
        (file("", &primitive("triangles", "<p>0 1 4</p>"), ""), "geometry 'square': a corner"),
        (file("", &primitive("triangles", "<p>0 1 -2</p>"), ""), "<p> has a word"),
        (file("", &primitive("polylist", "<vcount>5</vcount><p>0 1 2 3</p>"), ""), "<vcount>"),
        (file("", &TRIANGLES.replace("#corners", "#lost"), ""), "positions are missing"),
        (file("", TRIANGLES, &scene("<node><scale>1 2</scale></node>")), "<scale>"),
        (file("", TRIANGLES, &scene("<node><skew>1</skew></node>")), "<skew>"),
        (file("", TRIANGLES, &scene(endless)), "without end"),
        (file("", TRIANGLES, &scene(&many)), "without end"),
    ] {
        let error = read(text.as_bytes()).unwrap_err();
        assert!(error.contains(words), "{error} for {text}");
    }
}
