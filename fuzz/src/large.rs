//! Large inputs that are made by a rule, too large for the corpus.

use crate::kind::Kind;
use std::fmt::Write;

/// An input and what it is.
pub struct Large {
    /// What it is.
    pub name: &'static str,
    /// What it is read as.
    pub kind: Kind,
    /// Makes it.
    pub make: fn() -> String,
}

const fn large(kind: Kind, name: &'static str, make: fn() -> String) -> Large {
    Large { name, kind, make }
}

/// All of them.
pub const ALL: &[Large] = &[
    large(Kind::Urdf, "chain of 10 000 joints", || urdf(10_000, |k| k, "revolute")),
    large(Kind::Urdf, "star of 10 000 joints", || urdf(10_000, |_| 0, "revolute")),
    large(Kind::Urdf, "chain of 10 000 fixed joints", || urdf(10_000, |k| k, "fixed")),
    large(Kind::Urdf, "chain of 8000 floating joints", || urdf(8000, |k| k, "floating")),
    large(Kind::Urdf, "loop of 10 000 joints", || {
        urdf(10_000, |k| if k == 0 { 10_000 } else { k }, "revolute")
    }),
    large(Kind::Urdf, "quadratic entities", || {
        doctype(&format!("<!ENTITY a \"{}\">", "a".repeat(15_000)), 15_000)
    }),
    large(Kind::Urdf, "exponential entities", || {
        let entity = |k: usize| format!("<!ENTITY a{} \"{}\">", k + 1, format!("&a{k};").repeat(10));
        doctype(&("<!ENTITY a0 \"a\">".to_owned() + &(0..20).map(entity).collect::<String>()), 1)
    }),
    large(Kind::Urdf, "a million open elements", || "<robot>".repeat(1_000_000)),
    large(Kind::Urdf, "200 000 nested elements", || nested("<link>", "</link>", 200_000)),
    large(Kind::Urdf, "200 000 nested known elements", || {
        let inside = nested("<visual><geometry>", "</geometry></visual>", 100_000);
        format!("<robot name=\"r\"><link name=\"a\">{inside}</link></robot>")
    }),
    large(Kind::Urdf, "100 000 attributes", || {
        let attributes = (0..100_000).map(|k| format!(" a{k}=\"\"")).collect::<String>();
        format!("<robot{attributes}/>")
    }),
    large(Kind::Urdf, "255 attributes of 2000 elements", || {
        let attributes = (0..255).map(|k| format!(" a{k}=\"\"")).collect::<String>();
        format!("<robot>{}</robot>", format!("<link{attributes}/>").repeat(2000))
    }),
    large(Kind::Urdf, "100 000 namespaces", || {
        let declared = (0..100_000).map(|k| format!(" xmlns:a{k}=\"b\"")).collect::<String>();
        format!("<robot{declared}/>")
    }),
    large(Kind::Urdf, "200 namespaces of 100 000 elements", || {
        let declared = (0..200).map(|k| format!(" xmlns:a{k}=\"b{k}\"")).collect::<String>();
        format!("<robot{declared}>{}</robot>", "<a199:b/>".repeat(100_000))
    }),
    large(Kind::Urdf, "200 000 undeclared prefixes", || {
        let elements = (0..200_000).map(|k| format!("<a{k}:b/>")).collect::<String>();
        format!("<robot name=\"r\">{elements}</robot>")
    }),
    large(Kind::Urdf, "undeclared prefix of 8 MB", || format!("<robot><{}:b/></robot>", "a".repeat(8 << 20))),
    large(Kind::Urdf, "name of 8 MB and 100 000 elements", || {
        let name = "a".repeat(8 << 20);
        format!(
            "<robot name=\"r\"><link name=\"{name}\">{}</link></robot>",
            "<visual b=\"\"/>".repeat(100_000)
        )
    }),
    large(Kind::Urdf, "names of 1000 characters", || {
        urdf(2000, |k| k, "revolute").replace("\"l", &format!("\"{}", "l".repeat(1000)))
    }),
    large(Kind::Urdf, "16 MiB of <", || "<".repeat(16 << 20)),
    large(Kind::Urdf, "16 MiB of =", || format!("<robot name=\"{}\"/>", "=".repeat(16_000_000))),
    large(Kind::Urdf, "900 000 elements and equal signs", || {
        format!("<robot name=\"r\">{}</robot>", "<a b=\"\"/>".repeat(900_000))
    }),
    large(Kind::Urdf, "490 000 links", || {
        format!(
            "<robot name=\"r\">{}</robot>",
            (0..490_000).map(|k| format!("<link name=\"{k:x}\"/>")).collect::<String>()
        )
    }),
    large(Kind::Urdf, "200 000 links with unknown attributes", || {
        let link = |k: usize| format!("<link name=\"{k:x}\" a{k:x}=\"\" b=\"\"/>");
        format!("<robot name=\"r\">{}</robot>", (0..200_000).map(link).collect::<String>())
    }),
    large(Kind::Urdf, "9 MiB of lines and 300 000 elements", || {
        format!("<robot name=\"r\">{}{}</robot>", "\n".repeat(9 << 20), "<link name=\"a\"/>".repeat(300_000))
    }),
    large(Kind::Urdf, "16 MiB of comments", || format!("<robot>{}", "<!---->".repeat(2_300_000))),
    large(Kind::Urdf, "open comments", || "<!--".repeat(4_000_000)),
    large(Kind::Urdf, "open markup", || "<robot>".to_owned() + &"<!".repeat(8_000_000)),
    large(Kind::Urdf, "open sections", || "<robot>".to_owned() + &"<![CDATA[".repeat(1_800_000)),
    large(Kind::Urdf, "16 MiB of lines", || "\n".repeat(16 << 20)),
    large(Kind::Urdf, "16 MiB of colons", || format!("<robot>{}<a:b/></robot>", "a:".repeat(8_300_000))),
    large(Kind::Urdf, "17 MiB", || " ".repeat(17 << 20)),
    large(Kind::Urdf, "four million references", || {
        format!("<robot name=\"{}\"/>", "&lt;".repeat(4_000_000))
    }),
    large(Kind::Urdf, "a number of 16 MB", || {
        format!(
            "<robot name=\"r\"><link name=\"a\"><inertial><mass value=\"{}\"/></inertial></link></robot>",
            "1".repeat(16_000_000)
        )
    }),
    large(Kind::Urdf, "eight million numbers", || {
        format!(
            "<robot><joint name=\"j\" type=\"fixed\"><origin xyz=\"{}\"/></joint></robot>",
            "1 ".repeat(8_000_000)
        )
    }),
    large(Kind::Toml, "chain of 10 000 joints", || toml(10_000, "")),
    large(Kind::Toml, "star of 10 000 joints", || toml(10_000, "parent = \"world\"\n")),
    large(Kind::Toml, "tables with one key", || "[[joint]]\nname = \"a\"\n".repeat(150_000)),
    large(Kind::Toml, "400 000 empty tables", || "[[joint]]\n".repeat(400_000)),
    large(Kind::Toml, "29 000 joints", || {
        (0..29_000).map(|k| format!("[[joint]]\nname = \"{k:x}\"\nmass = 1\n")).collect()
    }),
    large(Kind::Toml, "half a million sources", || {
        format!("sources = [{}]\n{}", "'',".repeat(550_000), toml(3, ""))
    }),
    large(Kind::Toml, "110 000 rows", || format!("armature = [{}]\n{}", "[],".repeat(110_000), toml(3, ""))),
    large(Kind::Toml, "110 000 inline tables", || {
        format!("name = \"r\"\njoint = [{}]", "{name=''},".repeat(110_000))
    }),
    large(Kind::Toml, "inline tables", || format!("name = \"r\"\njoint = [{}]", "{},".repeat(1_300_000))),
    large(Kind::Toml, "nested arrays", || format!("name = {}", "[".repeat(1_000_000))),
    large(Kind::Toml, "nested closed arrays", || format!("armature = {}", nested("[", "]", 1_000_000))),
    large(Kind::Toml, "nested inline tables", || format!("name = {}", "{a=".repeat(500_000))),
    large(Kind::Toml, "a key of 100 000 dots", || format!("{}a = 1", "a.".repeat(100_000))),
    large(Kind::Toml, "a key of a million dots", || format!("{}a = 1", "a.".repeat(1_000_000))),
    large(Kind::Toml, "a header of 100 000 dots", || format!("[{}a]\nb = 1", "a.".repeat(100_000))),
    large(Kind::Toml, "many dotted keys", || (0..200_000).map(|k| format!("a.b{k} = 1\n")).collect()),
    large(Kind::Toml, "many keys", || (0..300_000).map(|k| format!("b{k} = 1\n")).collect()),
    large(Kind::Toml, "many headers", || (0..250_000).map(|k| format!("[b{k}]\n")).collect()),
    large(Kind::Toml, "an armature matrix of 700 rows", || {
        let row = format!("[{}],", "1.0,".repeat(700));
        format!("armature = [{}]\n{}", row.repeat(700), toml(700, ""))
    }),
    large(Kind::Toml, "an armature matrix of a million rows", || {
        format!("armature = [{}]\n{}", "[],".repeat(1_300_000), toml(3, ""))
    }),
    large(Kind::Toml, "gravity of a million numbers", || {
        format!("gravity = [{}]\n{}", "1,".repeat(1_000_000), toml(3, ""))
    }),
    large(Kind::Toml, "a million sources", || {
        format!("sources = [{}]\n{}", "'',".repeat(1_300_000), toml(3, ""))
    }),
    large(Kind::Toml, "a name of 4 MB", || {
        toml(2, "").replace("\"j1\"", &format!("\"{}\"", "x".repeat(4_000_000)))
    }),
    large(Kind::Toml, "a key of 4 MB", || format!("{} = 1", "x".repeat(4_000_000))),
    large(Kind::Toml, "five MiB", || " ".repeat(5 << 20)),
    large(Kind::Toml, "50 000 frames and wrenches", || {
        let frames = (0..25_000).map(|k| format!("[[frame]]\nname = 'f{k}'\n")).collect::<String>();
        let wrenches = (0..25_000).map(|k| format!("[[wrench]]\nframe = 'f{k}'\n")).collect::<String>();
        toml(3, "") + &frames + &wrenches
    }),
    large(Kind::Problem, "a MiB of frames, the last in none", || {
        let frames = (0..30_000).map(|k| format!("[[robot.frame]]\nname='{k}'\n")).collect::<String>();
        let table = "[robot]\nfile = \"../../robots/pendulum.toml\"\n";
        problem("robot = \"../../robots/pendulum.toml\"\n", &format!("{table}{frames}parent='none'\n"))
    }),
    large(Kind::Problem, "a MiB of wrenches", || {
        let wrenches = "[[robot.wrench]]\nframe='world'\n".repeat(30_000);
        let table = "[robot]\nfile = \"../../robots/pendulum.toml\"\n";
        problem("robot = \"../../robots/pendulum.toml\"\n", &format!("{table}{wrenches}"))
    }),
    large(Kind::Problem, "a million positions", || {
        problem("q = [0.0]", &format!("q = [{}]", "1,".repeat(1_000_000)))
    }),
    large(Kind::Problem, "300 000 free joints", || {
        problem("[end]", &format!("q_free = [{}]\n[end]", "'a',".repeat(300_000)))
    }),
    large(Kind::Problem, "a key of 100 000 dots", || format!("{}a = 1\n", "a.".repeat(100_000))),
    large(Kind::Problem, "nested arrays", || problem("q = [0.0]", &format!("q = {}", "[".repeat(1_000_000)))),
    large(Kind::Problem, "an unknown key of 4 MB", || format!("{} = 1\n", "x".repeat(4_000_000))),
    large(Kind::Problem, "a string of 4 MB for a number", || {
        problem("q = [0.0]", &format!("q = \"{}\"", "x".repeat(4_000_000)))
    }),
    large(Kind::Problem, "a robot whose path has 1 MB", || problem("pendulum.toml", &"x/".repeat(500_000))),
    large(Kind::Problem, "64 MB of lines", || "\n".repeat(64 << 20)),
    large(Kind::Problem, "300 000 unknown keys", || (0..300_000).map(|k| format!("b{k} = 1\n")).collect()),
    large(Kind::Problem, "a MiB of empty lists", || {
        problem("q = [0.0]", &format!("q = [{}]", "[],".repeat(345_000)))
    }),
    large(Kind::Problem, "a MiB of tables", || (0..120_000).map(|k| format!("[{k:x}]\n")).collect()),
    large(Kind::Problem, "a MiB of dots", || format!("{}a = 1\n", "a.".repeat(500_000))),
    large(Kind::Problem, "empty lists", || {
        problem("q = [0.0]", &format!("q = [{}]", "[],".repeat(5_000_000)))
    }),
    large(Kind::Solution, "nested arrays", || "[".repeat(1_000_000)),
    large(Kind::Solution, "nested objects", || "{\"trajectory\":".repeat(1_000_000)),
    large(Kind::Solution, "five million empty rows", || {
        rows("[0,1]", &format!("[{}[]]", "[],".repeat(5_000_000)))
    }),
    large(Kind::Solution, "two million rows", || {
        let times = (0..1_000_000).map(|k| format!("{k},")).collect::<String>();
        rows(&format!("[{times}1000001]"), &format!("[{}[0]]", "[0],".repeat(1_000_000)))
    }),
    large(Kind::Solution, "five rows of 1.6 million numbers", || {
        rows("[0,1]", &format!("[[{}0]]", "0,".repeat(1_600_000)))
    }),
    large(Kind::Solution, "16 MiB of rows", || {
        rows("[0,1]", &format!("[{}[0]]", "[0,0,0,0,0,0,0,0,0,0,0,0,0,0],".repeat(99_000)))
    }),
    large(Kind::Solution, "a row of two million numbers", || {
        rows("[0,1]", &format!("[[{}0]]", "0,".repeat(2_000_000)))
    }),
    large(Kind::Solution, "100 000 names of joints", || {
        rows("[0,1]", "[[0],[1]]").replacen(
            '{',
            &format!("{{\"joints\":[{}\"\"],", "\"x\",".repeat(100_000)),
            1,
        )
    }),
    large(Kind::Solution, "a status of 8 MB", || format!("{{\"status\":\"{}\"}}", "x".repeat(8 << 20))),
    large(Kind::Solution, "five million unknown keys", || {
        format!("{{{}\"a\":1}}", "\"b\":1,".repeat(5_000_000))
    }),
    large(Kind::Eval, "nested arrays", || "[".repeat(1_000_000)),
    large(Kind::Eval, "nested positions", || format!("{{\"q\":{}}}", nested("[", "]", 100_000))),
    large(Kind::Eval, "two million positions", || format!("{{\"q\":[{}0]}}", "0,".repeat(2_000_000))),
    large(Kind::Eval, "50 000 keys", || {
        let keys = (0..50_000).map(|k| format!("\"a{k}\":1,")).collect::<String>();
        format!("{{{keys}\"q\":[0]}}")
    }),
    large(Kind::Eval, "a million times the same key", || {
        format!("{{{}\"q\":[0]}}", "\"f\":1,".repeat(1_000_000))
    }),
    large(Kind::Eval, "a key of 8 MB", || format!("{{\"{}\":1}}", "x".repeat(8 << 20))),
    large(Kind::Eval, "two million empty arrays", || format!("{{\"f\":[{}0]}}", "[],".repeat(2_000_000))),
    large(Kind::Eval, "three million blanks", || " ".repeat(3_000_000)),
    large(Kind::Eval, "30 000 lines", || "{\"q\":[0.1],\"p\":[1.0]}\n".repeat(30_000)),
    large(Kind::Eval, "64 MB without a line end", || "1".repeat(64 << 20)),
];

fn nested(open: &str, close: &str, depth: usize) -> String {
    open.repeat(depth) + &close.repeat(depth)
}

/// Joint k carries link k + 1.
fn urdf(joints: usize, parent: impl Fn(usize) -> usize, kind: &str) -> String {
    let mut text = String::from("<robot name=\"large\">\n");
    let body = "<inertial><mass value=\"1\"/>\
                <inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>";
    // Writing to a string does not fail.
    for k in 0..=joints {
        writeln!(text, "<link name=\"l{k}\">{body}</link>").ok();
    }
    for k in 0..joints {
        let (above, below) = (parent(k), k + 1);
        let ends = format!("<parent link=\"l{above}\"/><child link=\"l{below}\"/>");
        writeln!(text, "<joint name=\"j{k}\" type=\"{kind}\"><origin xyz=\"0.1 0 0\"/><axis xyz=\"0 1 0\"/>{ends}</joint>").ok();
    }
    text + "</robot>\n"
}

/// `line` is added to each joint.
fn toml(joints: usize, line: &str) -> String {
    let joint = |k: usize| {
        let inertia = "inertia = { xx = 1.0, yy = 1.0, zz = 1.0 }";
        format!(
            "[[joint]]\nname = \"j{k}\"\nplacement = {{ xyz = [0.1, 0, 0] }}\nmass = 1.0\n{inertia}\n{line}\n"
        )
    };
    "name = \"large\"\n".to_owned() + &(0..joints).map(joint).collect::<String>()
}

fn doctype(entities: &str, uses: usize) -> String {
    format!(
        "<!DOCTYPE robot [{entities}]>\n<robot name=\"r\"><link name=\"{}\"/></robot>",
        "&a;".repeat(uses)
    )
}

/// The swing-up of a pendulum with one replacement.
fn problem(from: &str, to: &str) -> String {
    let text = "robot = \"../../robots/pendulum.toml\"\n[start]\nq = [0.0]\n[end]\nq = [1.0]\n\
                [time]\nfinal = 1.0\n[cost]\neffort = [1.0]\n";
    text.replacen(from, to, 1)
}

fn rows(t: &str, q: &str) -> String {
    format!(
        "{{\"status\":\"converged\",\"final_time\":1,\"trajectory\":{{\"t\":{t},\"q\":{q},\"v\":{q},\"p\":{q},\"u\":{q},\"y\":{q}}}}}"
    )
}
