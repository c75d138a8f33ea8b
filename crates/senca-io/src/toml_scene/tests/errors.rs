//! Every mistake has its place and says what would be right.

use super::error;

#[track_caller]
fn expect(text: &str, start: &str, parts: &[&str]) {
    let message = error(text);
    assert!(message.starts_with(start), "{message}\nshould start with {start}");
    for part in parts {
        assert!(message.contains(part), "{message}\nshould contain {part}");
    }
}

#[test]
fn broken_toml_has_its_place() {
    expect("a = 1\nb = = 2\n", "scene.toml:2:", &["not valid TOML"]);
    expect("name = \"x\nobject = 1", "scene.toml:1:", &["not valid TOML"]);
    expect("name = 1\nname = 2", "scene.toml:2:1: not valid TOML: duplicate key", &[]);
}

#[test]
fn text_that_is_not_utf8_has_its_place() {
    let bytes = b"name = \"a\"\n# \xff\n";
    let error = super::read("scene.toml", bytes, &crate::NoFiles, &super::no_models).expect_err("not UTF-8");
    assert_eq!(error.to_string(), "scene.toml:2:3: is not UTF-8 text");
}

#[test]
fn unknown_keys_are_refused_with_a_hint() {
    expect(
        "[[object]]\nshape = \"sphere\"\nraduis = 2\n",
        "scene.toml:3:1: unknown key \"raduis\" in the sphere; did you mean \"radius\"? Known here: ",
        &["\"center\"", "\"material\"", "\"translate\""],
    );
    expect(
        "[[objects]]\n",
        "scene.toml:1:3: unknown key \"objects\" in the scene; did you mean \"object\"?",
        &[],
    );
    expect(
        "[material.gold]\nqqq = 1",
        "scene.toml:2:1: unknown key \"qqq\" in material \"gold\". Known here: ",
        &[],
    );
    expect(
        "[[object]]\nshape = \"polygon\"\npoint = []",
        "scene.toml:3:1: unknown key \"point\"",
        &["\"points\"?"],
    );
    expect(
        "[[object]]\nshape=\"sphere\"\nambient = 1",
        "scene.toml:3:1: \"ambient\" belongs to the top",
        &[],
    );
}

#[test]
fn columns_count_characters() {
    expect("name = \"žába\"; x", "scene.toml:1:14: not valid TOML", &[]);
    expect("[[object]]\nname = 'ěšč'\n  ý = 1", "scene.toml:3:", &["not valid TOML"]);
    expect("object = [{ name = 'ěšč', x = 1 }]", "scene.toml:1:27: unknown key \"x\" in object \"ěšč\"", &[]);
}

#[test]
fn values_of_the_wrong_kind_are_named() {
    let sphere = |key: &str| format!("[[object]]\nshape = \"sphere\"\n{key}\n");
    expect(
        &sphere("radius = \"big\""),
        "scene.toml:3:10: \"radius\" should be a number, but is a string",
        &[],
    );
    expect(
        &sphere("center = 3"),
        "scene.toml:3:10: \"center\" should be a list of three numbers, but is a number",
        &[],
    );
    expect(&sphere("center = [1, 2]"), "scene.toml:3:10:", &["three numbers, but has 2 entries"]);
    expect(
        &sphere("center = [1, true, 2]"),
        "scene.toml:3:14:",
        &["should be a number, but is true or false"],
    );
    expect("object = 3", "scene.toml:1:10: \"object\" should be a table or a list of tables", &[]);
    expect("material = 3", "scene.toml:1:12: \"material\" needs names: write [material.NAME]", &[]);
    expect("[material]\ndiffuse = 1", "scene.toml:2:11:", &["should be a table, but is a number"]);
}

#[test]
fn values_outside_their_range_are_named() {
    let sphere = |key: &str| format!("[[object]]\nshape = \"sphere\"\n{key}\n");
    expect(&sphere("radius = -1"), "scene.toml:3:10: \"radius\" must be greater than 0, but is -1", &[]);
    expect(&sphere("radius = 0"), "scene.toml:3:10:", &["greater than 0"]);
    expect(&sphere("radius = nan"), "scene.toml:3:10: \"radius\" must be a finite number", &[]);
    expect(&sphere("radius = inf"), "scene.toml:3:10:", &["finite"]);
    expect(&sphere("radius = 1e300"), "scene.toml:3:10:", &["between -1e30 and 1e30"]);
    expect(&sphere("radius = 1e-300"), "scene.toml:3:10:", &["greater than 0"]);
    expect(&sphere("radius = 99999999999999999999999"), "scene.toml:3:10:", &["finite"]);
    expect(&sphere("scale = [1, 0, 1]"), "scene.toml:3:13:", &["must not be 0"]);
    expect(
        "[material.a]\ndiffuse = [1, 2, 0]",
        "scene.toml:2:11:",
        &["each part must be in [0, 1], but one is 2"],
    );
    expect("[material.a]\nalpha = 1.5", "scene.toml:2:9: \"alpha\" must be between 0 and 1, but is 1.5", &[]);
    expect(
        "[render]\nsize = [0, 5]",
        "scene.toml:2:9: \"size\" must be a whole number from 1 to 65536, but is 0",
        &[],
    );
    expect("[render]\nsize = [2.5, 5]", "scene.toml:2:9:", &["should be a whole number, but is a number"]);
    expect(
        "[fog]\ncolor = 1\nstart = 5\nend = 3",
        "scene.toml:4:7:",
        &["must be greater than \"start\", 5, but is 3"],
    );
}

#[test]
fn names_that_are_not_defined_get_a_hint() {
    expect(
        "[material.gold]\n[[object]]\nshape = \"sphere\"\nmaterial = \"gld\"",
        "scene.toml:4:12: material \"gld\" is not defined; did you mean \"gold\"?",
        &[],
    );
    expect("[[object]]\nmaterial = \"x\"", "scene.toml:2:12: material \"x\" is not defined; none is", &[]);
    expect("[material.a]\ntexture = \"b\"", "scene.toml:2:11: texture \"b\" is not defined", &[]);
    expect(
        "[material.a]\ntexture = \"b.png\"",
        "scene.toml:2:11:",
        &["for a file write { file = \"b.png\" }"],
    );
    expect("[define.wheel]\n[[object]]\nuse = \"weel\"", "scene.toml:3:7:", &["did you mean \"wheel\"?"]);
    expect("[[object]]\nshape = \"shpere\"", "scene.toml:2:9:", &["did you mean \"sphere\"?", "It can be"]);
    expect(
        "[[camera]]\nname = \"main\"\n[render]\ncamera = \"mian\"",
        "scene.toml:4:10:",
        &["did you mean \"main\"?"],
    );
    expect("background = \"blu\"", "scene.toml:1:14:", &["unknown colour \"blu\"; did you mean \"blue\"?"]);
    expect("background = \"#12345\"", "scene.toml:1:14:", &["three or six hexadecimal digits"]);
    let animation = "[[animation]]\nproperty = \"scale\"\ntimes = [0]\nvalues = [1]\nnode = \"bal\"";
    expect(
        &format!("[[object]]\nname = \"ball\"\n{animation}"),
        "scene.toml:7:8:",
        &["did you mean \"ball\"?"],
    );
    let two = format!("[[object]]\nname = \"bal\"\n[[object]]\nname = \"bal\"\n{animation}");
    expect(&two, "scene.toml:9:8: several objects are called \"bal\"", &[]);
}

#[test]
fn keys_that_exclude_each_other_are_named() {
    expect(
        "[[object]]\nshape = \"sphere\"\nuse = \"a\"",
        "scene.toml:3:7:",
        &["one of \"shape\", \"use\" and \"file\""],
    );
    expect("[[object]]\ntranslate = [1,0,0]\nmatrix = []", "scene.toml:2:13:", &["more than one way"]);
    expect("[material.a]\ndiffuse = 1\nmetallic = 1", "scene.toml:2:11:", &["mixes two models"]);
    expect("[material.a]\ncutoff = 0.5", "scene.toml:2:10:", &["alpha_mode = \"mask\""]);
    expect("[camera]\nfov = 40\nheight = 3", "scene.toml:3:10:", &["either \"fov\""]);
    expect(
        "[camera]\neye = [0,0,5]\nrotate = [0,1,0]",
        "scene.toml:3:10:",
        &["either by \"eye\" or by \"rotate\""],
    );
    expect("[texture.a]\nfile = \"x\"\ntexels = []", "scene.toml:3:10:", &["not both"]);
}

#[test]
fn lights_say_what_they_need() {
    expect("[light]\nkind = \"point\"", "scene.toml:1:", &["the point light needs the key \"position\""]);
    expect("[light]\nkind = \"spot\"\nposition = [0,1,0]", "scene.toml:1:", &["\"direction\" or \"target\""]);
    let spot = "[light]\nkind = \"spot\"\ndirection = [0,-1,0]\n";
    expect(spot, "scene.toml:1:", &["needs one of: \"angle\""]);
    expect(&format!("{spot}angle = 10\nexponent = 2"), "scene.toml:1:", &["needs one of"]);
    expect(&format!("{spot}outer = 10\ninner = 20"), "scene.toml:5:9:", &["must be below \"outer\""]);
    expect(&format!("{spot}angle = 200"), "scene.toml:4:9:", &["above 0 and at most 180"]);
    expect(
        "[light]\nkind = \"point\"\nposition = [0,0,0]\nattenuation = [0,0,0]",
        "scene.toml:4:15:",
        &["\"none\""],
    );
    expect(
        "[light]\nkind = \"spot\"\nangle = 3\ndirection = [0,0,0]",
        "scene.toml:4:13:",
        &["must not be zero"],
    );
}

#[test]
fn cameras_say_what_they_need() {
    expect("[camera]\nfov = 180", "scene.toml:2:7:", &["between 0 and 180"]);
    expect("[camera]\neye = [1,2,3]\ntarget = [1,2,3]", "scene.toml:3:10:", &["same place as \"eye\""]);
    expect("[camera]\neye = [0,5,0]\ntarget = [0,0,0]\nup = [0,1,0]", "scene.toml:4:6:", &["parallel"]);
    expect("[camera]\nnear = 5\nfar = 3", "scene.toml:3:7:", &["greater than \"near\", 5"]);
    let b = |change: &str| {
        let mut keys = vec![
            "vpn = [0,0,1]",
            "vup = [0,1,0]",
            "prp = [0,0,5]",
            "window = [-1,1,-1,1]",
            "front = 1",
            "back = -5",
        ];
        let name = change.split(' ').next().unwrap_or_default();
        keys.retain(|key| key.split(' ').next() != Some(name));
        format!("[camera]\noperation = \"B\"\n{change}\n{}", keys.join("\n"))
    };
    assert!(super::read_text(&b("front = 2")).is_ok());
    expect(&b("vup = [0,0,2]"), "scene.toml:3:7: VUP, the up vector, is parallel to VPN", &[]);
    expect(&b("vpn = [0,0,0]"), "scene.toml:3:7: VPN, the normal of the view plane, is zero", &[]);
    expect(&b("prp = [0,0,0]"), "scene.toml:3:7: PRP lies in the view plane", &[]);
    expect(&b("window = [1,1,-1,1]"), "scene.toml:3:10: the window is empty", &[]);
    expect(&b("front = 5"), "scene.toml:3:9: the front plane at 5 does not lie before the eye", &[]);
    expect(&b("back = 1"), "scene.toml:3:8: the front plane F and the back plane B are the same", &[]);
    let a =
        "[camera]\noperation = \"A\"\np = [0,0,5]\nf = 2\nwindow = [-1,1,-1,1]\nfront = 0\nback = -9\nn = ";
    expect(&format!("{a}[0,0,2]"), "scene.toml:8:5:", &["must have length 1, but its length is 2"]);
    assert!(super::read_text(&format!("{a}[0,0,1]")).is_ok());
}

#[test]
fn meshes_are_checked() {
    let mesh =
        |keys: &str| format!("[[object]]\nshape = \"mesh\"\npoints = [[0,0,0],[1,0,0],[0,1,0]]\n{keys}");
    assert!(super::read_text(&mesh("faces = [[0,1,2]]")).is_ok());
    expect(&mesh(""), "scene.toml:1:", &["a mesh needs \"faces\""]);
    expect(
        &mesh("faces = [[0,1,3]]"),
        "scene.toml:4:15:",
        &["names point 3, but there are only 3, counted from 0"],
    );
    expect(&mesh("faces = [[0,1]]"), "scene.toml:4:10:", &["a face with 2 corners"]);
    expect(&mesh("faces = [[0,1,-1]]"), "scene.toml:4:15:", &["whole number"]);
    expect(
        &mesh("faces = [[0,1,2]]\nnormals = [[0,0,1]]"),
        "scene.toml:5:11:",
        &["each of the 3 points, but has 1"],
    );
    expect(&mesh("faces = [[0,1,2]]\nface_uv = []"), "scene.toml:5:11:", &["each of the 1 faces"]);
    expect(
        &mesh("faces = [[0,1,2]]\nface_uv = [[[0,0]]]"),
        "scene.toml:5:12:",
        &["1 pairs for a face with 3"],
    );
    expect(&mesh("faces = [[0,1,2]]\nmorph_weights = [1]"), "scene.toml:5:17:", &["more weights than"]);
    expect(
        "[[object]]\nshape = \"quad-strip\"\npoints = [[0,0,0],[1,0,0],[0,1,0],[1,1,0],[2,2,2]]",
        "scene.toml:3:10:",
        &["even number"],
    );
    expect(
        "[[object]]\nshape = \"quad-mesh\"\nrows = [[[0,0,0],[1,0,0]],[[0,1,0]]]",
        "scene.toml:3:",
        &["at least 2 points"],
    );
}

#[test]
fn curved_surfaces_are_checked() {
    expect(
        "[[object]]\nshape = \"bezier\"\npoints = [[0,0,0]]",
        "scene.toml:3:10:",
        &["16 points", "has 1 points"],
    );
    expect("[[object]]\nshape = \"bezier\"\npatches = []", "scene.toml:3:11:", &["has no patch"]);
    expect(
        "[[object]]\nshape = \"revolution\"\nprofile = [[1,0],[-1,2]]",
        "scene.toml:3:18:",
        &["negative radius -1"],
    );
    expect(
        "[[object]]\nshape = \"revolution\"\nbezier = true\nprofile = [[1,0],[1,2]]",
        "scene.toml:4:11:",
        &["4, 7, 10"],
    );
    let nurbs = "[[object]]\nshape = \"nurbs\"\npoints = [[[0,0,0],[1,0,0]],[[0,1,0],[1,1,0]]]\n";
    assert!(super::read_text(nurbs).is_ok());
    expect(&format!("{nurbs}degree = 2"), "scene.toml:4:10:", &["needs more than 2 points"]);
    expect(&format!("{nurbs}knots_u = [0,1]"), "scene.toml:4:11:", &["2 + 1 + 1 = 4 knots, but has 2"]);
    expect(&format!("{nurbs}knots_u = [0,1,0,1]"), "scene.toml:4:11:", &["must not decrease"]);
    expect(&format!("{nurbs}knots_u = [1,1,1,1]"), "scene.toml:4:11:", &["leaves no range"]);
    expect(&format!("{nurbs}weights = [[1,1]]"), "scene.toml:4:11:", &["2 rows of 2 weights"]);
    expect(&format!("{nurbs}weights = [[1,0],[1,1]]"), "scene.toml:4:15:", &["greater than 0"]);
}

#[test]
fn matrices_for_row_vectors_are_told_apart() {
    let object = |rows: &str| format!("[[object]]\nmatrix = {rows}");
    expect(
        &object("[[1,0,0,0],[0,1,0,0],[0,0,1,0],[5,0,0,1]]"),
        "scene.toml:2:10:",
        &["exchange its rows and columns"],
    );
    expect(&object("[[1,0,0,0],[0,1,0,0],[0,0,0,0],[0,0,0,1]]"), "scene.toml:2:10:", &["singular"]);
    expect(&object("[[1,0,0],[0,1,0]]"), "scene.toml:2:10:", &["four rows of four numbers"]);
}

#[test]
fn animations_are_checked() {
    let base = "[[object]]\nname = \"a\"\n[[animation]]\nnode = \"a\"\n";
    let turn = |keys: &str| format!("{base}property = \"rotate\"\n{keys}");
    expect(
        &turn("times = [0, 0]\nvalues = [[0,0,0],[0,0,0]]"),
        "scene.toml:6:9:",
        &["must increase, but 0 follows 0"],
    );
    expect(&turn("times = []\nvalues = []"), "scene.toml:6:9:", &["at least one time"]);
    expect(&turn("times = [0]\nvalues = []"), "scene.toml:7:10:", &["each of the 1 times, but has 0"]);
    expect(&turn("times = [0,1]\nvalues = [[0,0,0],[0,1e9,0]]"), "scene.toml:7:10:", &["turns too far"]);
    expect(
        &format!("{base}property = \"path\"\ntimes = [0]\npoints = [[0,0,0]]"),
        "scene.toml:7:10:",
        &["4, 7, 10"],
    );
}

#[test]
fn definitions_that_use_themselves_are_refused() {
    expect("[define.a]\nuse = \"a\"", "scene.toml:2:7: definition \"a\" uses itself", &[]);
    expect("[define.a]\nuse = \"b\"\n[define.b]\nuse = \"a\"", "scene.toml:", &["uses itself"]);
}

#[test]
fn definitions_that_multiply_are_limited() {
    let mut text = "[define.d0]\nshape = \"sphere\"\n".to_owned();
    for level in 1..30 {
        let below = level - 1;
        text += &format!("[define.d{level}]\nchild = [{{ use = \"d{below}\" }}, {{ use = \"d{below}\" }}]\n");
    }
    let message = error(&text);
    assert!(message.contains("more than 1048576 nodes"), "{message}");
}

#[test]
fn long_chains_of_definitions_are_limited() {
    let links: Vec<String> = (0..10_000).map(|i| format!("[define.d{i}]\nuse = \"d{}\"\n", i + 1)).collect();
    let text = links.concat() + "[define.d10000]\n";
    let message = error(&text);
    assert!(message.contains("deep"), "{message}");
}

#[test]
fn deep_nesting_is_an_error() {
    let lists = format!("name = {}{}", "[".repeat(100_000), "]".repeat(100_000));
    expect(&lists, "scene.toml:1:", &["not valid TOML"]);
    let tables = format!("object = {}{}", "{ child = ".repeat(10_000), "}".repeat(10_000));
    expect(&tables, "scene.toml:1:", &["not valid TOML"]);
    let header = format!("[[object{}]]", ".child".repeat(10_000));
    expect(&header, "scene.toml:1:", &[]);
}

#[test]
fn texts_above_the_limit_are_refused_before_they_are_parsed() {
    let text = " ".repeat(super::super::LARGEST_TEXT + 1);
    let message = error(&text);
    assert!(message.contains("put large meshes into"), "{message}");
}

#[test]
fn formulas_show_their_mistake() {
    let implicit = |rest: &str| format!("[[object]]\nshape = 'implicit'\n{rest}");
    expect(&implicit("expression = 'x^2 + + )'"), "scene.toml:3:23:", &["column 9", "found \")\""]);
    expect(&implicit("expression = \"\"\"\nx +\n  q\"\"\""), "scene.toml:5:3:", &["unknown name \"q\""]);
    expect(&implicit("expression = 3"), "scene.toml:3:14:", &["a string"]);
    expect(&implicit("min = 1"), "scene.toml:1:", &["expression"]);
    expect(&implicit("expression = 'x'\nmin = 2"), "scene.toml:4:7:", &["greater than"]);
}

#[test]
fn bodies_are_checked() {
    let csg = |rest: &str| format!("[[object]]\nshape = 'csg'\n{rest}");
    let bodies = |list: &str| csg(&format!("operation = 'union'\nbodies = [{list}]"));
    expect(&csg("operation = 'onion'\nbodies = []"), "scene.toml:3:13:", &["did you mean \"union\""]);
    expect(&csg("operation = 'union'"), "scene.toml:1:", &["bodies"]);
    expect(&bodies("{ shape = 'sphere' }"), "scene.toml:4:10:", &["two bodies or more"]);
    let open = "{ shape = 'sphere' }, { shape = 'cylinder', name = 'pipe', capped = false }";
    expect(&bodies(open), "scene.toml:4:33:", &["cylinder \"pipe\"", "capped = true"]);
    expect(&bodies("{ shape = 'sphere' }, { shape = 'disc' }"), "scene.toml:4:33:", &["no inside"]);
    expect(&bodies("{ shape = 'sphere' }, { shape = 'plane' }"), "scene.toml:1:", &["no end"]);
    expect(&bodies("{ shape = 'sphere' }, { shape = 'sphere', rad = 1 }"), "scene.toml:4:53:", &["radius"]);
    expect(&bodies("{ shape = 'sphere' }, { radius = 1 }"), "scene.toml:4:33:", &["operation"]);
    let deep = format!("{}{}", "{ operation = 'union', bodies = [".repeat(40), "]}".repeat(40));
    assert!(!error(&bodies(&deep)).is_empty());
}
