//! What the commands of the program answer, and what they refuse.

use std::fs;

use serde_json::Value;

mod kit;

use kit::{ACTING, answer, cowbell, file, nothing_acts, refusal};

/// Runs a command that must succeed; its JSON.
fn json(arguments: &[&str]) -> Value {
    let output = answer(arguments);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {stderr}");
    let text = String::from_utf8(output.stdout).expect("JSON is UTF-8");
    assert_eq!(text.matches('\n').count(), 1, "one line");
    serde_json::from_str(&text).expect("the answer is JSON")
}

fn keys(value: &Value) -> Vec<&str> {
    let mut keys: Vec<&str> = value
        .as_object()
        .map(|object| object.keys().map(String::as_str).collect())
        .unwrap_or_default();
    keys.sort_unstable();
    keys
}

#[test]
fn run_prints_the_final_state() {
    let state = json(&["run", "parabola", "--steps", "60", "--json"]);
    assert_eq!(
        keys(&state),
        [
            "bodies",
            "contacts",
            "dissipates",
            "driven",
            "energy_drift",
            "energy_error",
            "impacts",
            "kinetic_energy",
            "last_impact",
            "momentum",
            "momentum_drift",
            "momentum_error",
            "overlaps",
            "path_error",
            "potential_energy",
            "separated",
            "state_hash",
            "steps",
            "time",
            "total_energy"
        ]
    );
    assert_eq!(state["steps"], 60);
    assert_eq!(state["time"].as_f64(), Some(60.0 / 60.0));
    assert_eq!(state["momentum"].as_array().map(Vec::len), Some(3));
    let body = &state["bodies"][0];
    assert_eq!(keys(body), ["mass", "name", "position", "velocity"]);
    assert_eq!(body["position"].as_array().map(Vec::len), Some(3));
}

#[test]
fn energies_and_errors_are_told_as_far_as_they_are_known() {
    for method in sim_core::METHODS {
        let arguments = ["run", "spring", "--steps", "200", "--json", "--method"];
        let state = json(&[&arguments[..], &[method.name]].concat());
        let energy = |name: &str| state[name].as_f64().expect("a number");
        let total = energy("kinetic_energy") + energy("potential_energy");
        assert_eq!(energy("total_energy"), total);
        // It begins with 5 J, all in the spring.
        let keeps = !matches!(
            method.name,
            "forward-euler" | "backward-euler" | "symplectic-euler"
        );
        assert_eq!(
            (total - 5.0).abs() < 0.01,
            keeps,
            "{}: {total}",
            method.name
        );
        assert_eq!(
            energy("energy_drift").abs() < 2e-3,
            keeps,
            "{}",
            method.name
        );
        // The ellipse is known; what the centre does to the momentum is not.
        let error = state["path_error"].as_f64().expect("known");
        assert_eq!(error < 0.01, keeps, "{}: {error}", method.name);
        assert!(state["momentum_drift"].is_null());
    }
    let loose = [
        "run",
        "kepler",
        "--json",
        "--method",
        "dopri5",
        "--tolerance",
    ];
    let drift = |tolerance| {
        let state = json(&[&loose[..], &[tolerance]].concat());
        state["energy_drift"].as_f64().expect("a number").abs()
    };
    assert!(drift("1e-3") > 100.0 * drift("1e-12"));
    let text = refusal(cowbell(&["run", "kepler", "--tolerance", "nan"]), 2);
    assert!(
        text.contains("--tolerance") && text.contains("1e-15"),
        "{text}"
    );
    let text = refusal(cowbell(&["run", "stiff-spring", "--method", "rk4"]), 1);
    assert!(
        text.contains("`cube`") && text.contains("2.6225e-3 s"),
        "{text}"
    );
}

/// Runs a scene written here: its JSON, and what the table says in the row of that name.
fn scene_text(name: &str, text: &str, steps: &str) -> (Value, impl Fn(&str) -> String + use<>) {
    let path = file(name, text);
    let run = ["run", &path.to_string_lossy(), "--steps", steps];
    let state = json(&[&run[..], &["--json"]].concat());
    let table = String::from_utf8(answer(&run).stdout).expect("text");
    fs::remove_file(path).expect("the file is removed");
    let row = move |name: &str| {
        let mut lines = table.lines();
        let line = lines.find_map(|line| line.strip_prefix(name));
        line.unwrap_or_else(|| panic!("{name} is not in\n{table}"))
            .trim()
            .to_owned()
    };
    (state, row)
}

#[test]
fn an_energy_without_bound_is_not_told_as_a_small_drift() {
    let text = "rate = 60\nmethod = 'forward-euler'\n[[body]]\nname = 'weight'\nsphere = 0.1\n\
                position = [1, 0, 0]\n[[force]]\nkind = 'anchor'\nbody = 'weight'\n\
                anchor = [0, 0, 0]\nstiffness = 8\n";
    let (state, row) = scene_text("gains.toml", text, "1200");
    // Forward Euler multiplies the energy by 1 + k dt²/m in each step.
    let exact = (1.0_f64 + 8.0 / 3600.0).powi(1200) - 1.0;
    let drift = state["energy_drift"].as_f64().expect("a number");
    assert!((drift / exact - 1.0).abs() < 1e-9, "{drift}, not {exact}");
    let error = state["energy_error"].as_f64().expect("a number");
    assert!((error / (4.0 * exact) - 1.0).abs() < 1e-9, "{error} J");
    assert_eq!(
        (&state["dissipates"], &state["driven"]),
        (&Value::Bool(false), &Value::Bool(false))
    );
    assert_eq!(row("Energy drift"), "+13 (+53 J)");
    assert!(row("Momentum drift").contains("unknown"));
    // Friction takes energy. A method that makes it grow all the same errs.
    let damped = format!("{text}damping = 0.01\n");
    let (state, row) = scene_text("gains-damped.toml", &damped, "1200");
    assert!(
        state["energy_drift"]
            .as_f64()
            .is_some_and(|drift| drift > 1.0)
    );
    assert_eq!(state["dissipates"], true);
    assert!(
        row("Energy drift").contains("an error"),
        "{}",
        row("Energy drift")
    );
    let braked = format!("{text}damping = 1\n");
    let (_, row) = scene_text("loses.toml", &braked, "1200");
    assert!(
        row("Energy drift").contains("no error"),
        "{}",
        row("Energy drift")
    );
}

#[test]
fn without_energy_at_the_start_its_drift_is_told_in_joules() {
    // One falls from the height that weight is counted from, two from both sides of it.
    for places in [&["0"][..], &["0.1", "-0.1"]] {
        let mut text = "rate = 60\nmethod = 'forward-euler'\n\
                        [[force]]\nkind = 'gravity'\nacceleration = [0, -9.81, 0]\n"
            .to_owned();
        for (i, y) in places.iter().enumerate() {
            text +=
                &format!("[[body]]\nname = 'stone {i}'\nsphere = 0.01\nposition = [{i}, {y}, 0]\n");
        }
        let (state, row) = scene_text(&format!("falls-{}.toml", places.len()), &text, "60");
        assert!(state["energy_drift"].is_null(), "{state}");
        // It falls 9.81/2 m less half a step's fall a step: g² t dt / 2 too high.
        let exact = places.len() as f64 * 9.81 * 9.81 / 120.0;
        let error = state["energy_error"].as_f64().expect("a number");
        assert!((error / exact - 1.0).abs() < 1e-9, "{error} J, not {exact}");
        assert!(row("Energy drift").ends_with("J (0 at the start)"));
        // The weight's impulse is what the momentum is measured by.
        assert!(
            state["momentum_drift"]
                .as_f64()
                .is_some_and(|drift| drift < 1e-12)
        );
    }
}

#[test]
fn help_explains_every_figure_that_its_name_does_not() {
    let help = String::from_utf8(answer(&["run", "--help"]).stdout).expect("text");
    let state = json(&["run", "parabola", "--steps", "1", "--json"]);
    let plain = [
        "bodies",
        "impacts",
        "kinetic_energy",
        "last_impact",
        "momentum",
        "steps",
        "time",
    ];
    for key in keys(&state) {
        assert!(plain.contains(&key) || help.contains(key), "{key}");
    }
}

/// Two balls in each other, one of them in a floor.
fn overlapping(name: &str) -> String {
    format!(
        "rate = 60\ntitle = 'Overlap'\n[[body]]\nname = 'floor'\nhalf-space = [0, 1, 0]\nimmovable = true\n\
         [[body]]\nname = \"{name}\"\nsphere = 0.5\nposition = [0, 0.25, 0]\n\
         [[body]]\nname = 'right'\nsphere = 0.5\nmass = 3\nposition = [0.75, 0.75, 0]\n"
    )
}

#[test]
fn overlaps_are_told_with_names_and_depth_and_can_be_separated() {
    let path = file("overlap.toml", &overlapping("left"));
    let path_text = path.to_string_lossy();
    let run = ["run", &path_text, "--steps", "5"];
    let state = json(&[&run[..], &["--json"]].concat());
    let overlaps = state["overlaps"].as_array().expect("a list");
    assert_eq!(overlaps.len(), 2);
    assert_eq!(overlaps[0]["bodies"], serde_json::json!(["floor", "left"]));
    assert_eq!(overlaps[0]["depth"].as_f64(), Some(0.25));
    assert_eq!(overlaps[0]["normal"], serde_json::json!([0.0, 1.0, 0.0]));
    assert_eq!(overlaps[1]["bodies"], serde_json::json!(["left", "right"]));
    let depth = overlaps[1]["depth"].as_f64().expect("a number");
    assert!((depth - (1.0 - 0.8125_f64.sqrt())).abs() < 1e-15, "{depth}");
    assert_eq!(overlaps[1]["is_least"], true);
    assert_eq!(state["separated"], serde_json::json!([]));
    let held = state["contacts"].as_array().expect("a list");
    assert!(
        held.iter().all(|contact| contact["is_overlap"] == true),
        "{held:?}"
    );
    let table = String::from_utf8(answer(&run).stdout).expect("text");
    for words in ["floor and left at the start, 0.2500 m deep", "--separate"] {
        assert!(table.contains(words), "{words} is not in\n{table}");
    }
    let run = [&run[..], &["--separate"]].concat();
    let state = json(&[&run[..], &["--json"]].concat());
    assert_eq!(state["overlaps"], serde_json::json!([]));
    assert_eq!(state["separated"], serde_json::json!(["left", "right"]));
    let contacts = state["contacts"].as_array().expect("a list");
    assert_eq!(contacts.len(), 2, "{contacts:?}");
    for contact in contacts {
        assert_eq!(
            (&contact["count"], &contact["is_overlap"]),
            (&1.into(), &false.into())
        );
        assert!(
            contact["gap"]
                .as_f64()
                .is_some_and(|gap| (0.0..1e-11).contains(&gap))
        );
        assert_eq!(contact["normal"].as_array().map(Vec::len), Some(3));
    }
    let table = String::from_utf8(answer(&run).stdout).expect("text");
    assert!(
        table.contains("left, right, moved out of overlap"),
        "{table}"
    );
    assert!(!table.contains(" deep"), "{table}");
    fs::remove_file(path).expect("the file is removed");
}

#[test]
fn what_cannot_be_separated_is_refused_by_its_name() {
    let name = ACTING
        .replace('\u{1b}', "\\u001b")
        .replace('\u{7}', "\\u0007");
    let wall = "[[body]]\nname = 'ceiling'\nhalf-space = [0, -1, 0]\nimmovable = true\nposition = [0, 0.9, 0]\n";
    let path = file("caught.toml", &(overlapping(&name) + wall));
    let path_text = path.to_string_lossy();
    let run = ["run", &path_text, "--steps", "5"];
    nothing_acts(&answer(&run));
    let run = [&run[..], &["--separate"]].concat();
    let text = refusal(cowbell(&run), 2);
    assert!(
        text.contains("does not fit between the half-spaces floor, ceiling"),
        "{text}"
    );
    nothing_acts(&answer(&run));
    fs::remove_file(path).expect("the file is removed");
}

#[test]
fn numbers_survive_json_bit_for_bit() {
    let steps = 1234;
    let scene = scene::Scene::load("cube-cow").expect("it is in the gallery");
    let mut world = scene.world().expect("it makes a world");
    for _ in 0..steps {
        world.step().expect("nothing grows in it");
    }
    let state = json(&["run", "cube-cow", "--steps", "1234", "--json"]);
    for (i, body) in state["bodies"].as_array().into_iter().flatten().enumerate() {
        for (field, vector) in [
            ("position", world.position(i)),
            ("velocity", world.velocity(i)),
        ] {
            for (axis, exact) in vector.to_array().into_iter().enumerate() {
                let written = body[field][axis].to_string();
                let read: f64 = written.parse().expect("a number");
                assert_eq!(read.to_bits(), exact.to_bits(), "{field} of body {i}");
            }
        }
    }
    assert_eq!(state["impacts"], world.impacts());
    assert_eq!(state["state_hash"], format!("{:016x}", world.state_hash()));
}

#[test]
fn run_obeys_its_options() {
    let run = |more: &[&str]| json(&[&["run", "five-hertz", "--json"], more].concat());
    let end = |state: &Value| state["bodies"][0]["position"][1].as_f64();
    let forward = run(&["--steps", "20", "--method", "forward-euler"]);
    let backward = run(&["--steps", "20", "--method", "backward-euler"]);
    assert_ne!(end(&forward), end(&backward));
    let finer = run(&["--steps", "20", "--rate", "100"]);
    assert_eq!(finer["time"].as_f64().map(|t| (t * 1e9).round()), Some(2e8));
    assert_eq!(run(&["--steps", "2", "--dt", "0.5"])["time"], 1.0);
    assert_eq!(run(&["--steps", "0"])["steps"], 0);
    let naive = json(&["run", "two-cubes", "--collision", "naive", "--json"]);
    let bvh = json(&["run", "two-cubes", "--collision", "bvh", "--json"]);
    assert_eq!(naive, bvh);
}

#[test]
fn run_prints_a_table_with_speed_and_error() {
    let output = answer(&["run", "two-cubes"]);
    let text = String::from_utf8_lossy(&output.stdout);
    for word in ["µs a step", "drift", "Impacts", "heavy", "J"] {
        assert!(text.contains(word), "{word} is not in\n{text}");
    }
}

#[test]
fn bad_arguments_give_one_line_and_code_2() {
    let cases: &[&[&str]] = &[
        &["run"],
        &["run", "no-such-scene"],
        &["no-such-scene"],
        &["run", "no-such-file.toml"],
        &["run", "cube-cow", "--method", "magic"],
        &["run", "cube-cow", "--dt", "0"],
        &["run", "cube-cow", "--dt", "-1"],
        &["run", "cube-cow", "--dt", "nan"],
        &["run", "cube-cow", "--rate", "inf"],
        &["run", "cube-cow", "--dt", "1", "--rate", "1"],
        &["run", "cube-cow", "--steps", "-1"],
        &["run", "cube-cow", "--collision", "maybe"],
        &["run", "cube-cow", "--frobnicate"],
        &["check"],
        &["check", "no-such-file.obj"],
        &["check", "/"],
        &["shot", "cube-cow"],
        &["shot", "cube-cow", "-o", "x.png", "--size", "0x10"],
        &["shot", "cube-cow", "-o", "x.png", "--size", "wide"],
        &["shot", "cube-cow", "-o", "x.png", "--bvh", "deep"],
        &["shot", "cube-cow", "-o", "x.png", "--bvh", "9999"],
        &["shot", "cube-cow", "-o", "x.png", "--select", "nobody"],
    ];
    for arguments in cases {
        refusal(cowbell(arguments), 2);
    }
}

#[test]
fn refusals_name_the_choices() {
    let text = refusal(cowbell(&["run", "cube-cow", "--method", "magic"]), 2);
    for method in sim_core::METHODS {
        assert!(text.contains(method.name), "{text}");
    }
    let text = refusal(cowbell(&["run", "nothing"]), 2);
    for entry in scene::SCENES {
        assert!(text.contains(entry.name), "{text}");
    }
}

#[test]
fn run_out_of_numbers_ends_with_code_1_body_and_step() {
    let path = file(
        "overflow.toml",
        "title = \"Too much\"\nrate = 60\n[[body]]\nname = \"runaway\"\nmesh = \"cube.obj\"\n\
         velocity = [1e100, 0, 0]\nforce = [1e100, 0, 0]\nmass = 1e-100\n",
    );
    let path_text = path.to_string_lossy();
    let command = cowbell(&["run", &path_text, "--dt", "1e60", "--json"]);
    let text = refusal(command, 1);
    assert!(
        text.contains("runaway") && text.contains("step 1"),
        "{text}"
    );
    fs::remove_file(path).expect("the file is removed");
}

#[test]
fn check_describes_a_mesh() {
    let path = file(
        "square.obj",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 9 9 9\nf 1 2 3 4\nf 1 2 3\n",
    );
    let report = json(&["check", &path.to_string_lossy(), "--json"]);
    assert_eq!(
        keys(&report),
        [
            "boundary_edges",
            "closed",
            "components",
            "extent",
            "format",
            "non_manifold_edges",
            "oriented",
            "repairs",
            "triangles",
            "unit",
            "up_axis",
            "vertices",
            "volume"
        ]
    );
    assert_eq!(report["format"], "obj");
    assert_eq!(report["closed"], false);
    assert_eq!(report["volume"], Value::Null);
    let repairs = report["repairs"].as_array().expect("an array");
    assert!(!repairs.is_empty());
    assert!(repairs.iter().all(|r| keys(r) == ["count", "kind"]));
    assert!(answer(&["check", &path.to_string_lossy()]).status.success());
    fs::remove_file(path).expect("the file is removed");
}

#[test]
fn check_refuses_what_makes_no_mesh() {
    let path = file("broken.obj", "v 0 0 0\nf 1 2 3\n");
    let path_text = path.to_string_lossy();
    let text = refusal(cowbell(&["check", &path_text, "--json"]), 2);
    assert!(text.contains("broken.obj"), "{text}");
    fs::remove_file(path).expect("the file is removed");
}

#[test]
fn a_soak_looks_at_each_step_of_every_scene() {
    let output = cowbell(&["soak", "all", "--minutes", "0.1"])
        .output()
        .expect("it runs");
    let text = String::from_utf8(output.stdout).expect("text");
    let wrong = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{wrong}");
    assert_eq!(text.lines().count(), 1 + scene::SCENES.len(), "{text}");
    let output = cowbell(&["soak", "all", "--minutes", "-1"])
        .output()
        .expect("it runs");
    assert_eq!(output.status.code(), Some(2));
}

/// The lines of a table of comma-separated values, cut into fields.
fn table(arguments: &[&str]) -> Vec<Vec<String>> {
    let output = answer(arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}");
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    let cut = |line: &str| line.split(',').map(str::to_owned).collect();
    text.lines().map(cut).collect()
}

#[test]
fn run_can_print_every_state() {
    let states = table(&["run", "five-hertz", "--steps", "20", "--csv"]);
    assert_eq!(states.len(), 22);
    assert_eq!(states[0][..3], ["time_s", "step", "kinetic_energy_J"]);
    assert!(states.iter().all(|line| line.len() == states[0].len()));
    let column = |name: &str| {
        let at = states[0].iter().position(|title| title == name);
        let at = at.unwrap_or_else(|| panic!("{name}"));
        let values = states[1..].iter().map(move |line| line[at].parse::<f64>());
        values.collect::<Vec<_>>()
    };
    let last = |name: &str| column(name).pop().expect("a state").expect("a number");
    assert!((last("time_s") - 4.0).abs() < 1e-12 && last("step") == 20.0);
    // Forward Euler leaves out a half of F/m dt in each step, so it gains force times that.
    assert!((last("path_error_m") - 0.4).abs() < 1e-12);
    assert!((last("total_energy_J") - 4.4).abs() < 1e-12);
    assert!(
        column("step_cost_s")[0].is_err(),
        "no step led to the first state"
    );
}

#[test]
fn compare_runs_every_combination_and_the_exact_solution() {
    let rows = json_array(&[
        "compare",
        "five-hertz",
        "--method",
        "forward-euler,rk4",
        "--rate",
        "5,60",
        "--json",
    ]);
    let names: Vec<&str> = rows.iter().filter_map(|row| row["run"].as_str()).collect();
    assert_eq!(
        names,
        [
            "forward-euler 5 Hz bvh",
            "forward-euler 60 Hz bvh",
            "rk4 5 Hz bvh",
            "rk4 60 Hz bvh",
            "exact"
        ]
    );
    let error = |row: usize| rows[row]["path_error"].as_f64().expect("known");
    assert!((error(0) - 0.4).abs() < 1e-12, "{}", error(0));
    assert!((error(1) - 4.0 * 0.5 / 60.0).abs() < 1e-12, "{}", error(1));
    assert!(error(2) < 1e-12 && error(3) < 1e-12 && error(4) == 0.0);
    let lines = table(&[
        "compare",
        "five-hertz",
        "--method",
        "forward-euler,rk4",
        "--rate",
        "5,60",
        "--csv",
    ]);
    assert_eq!(lines[0][..2], ["run", "time_s"]);
    let of = |name: &str| lines.iter().filter(|line| line[0] == name).count();
    assert_eq!(
        (
            of("forward-euler 5 Hz bvh"),
            of("rk4 60 Hz bvh"),
            of("exact")
        ),
        (21, 241, 241)
    );
    let text = answer(&[
        "compare",
        "bullet",
        "--collision",
        "bvh,continuous",
        "--time",
        "0.5",
    ]);
    let text = String::from_utf8(text.stdout).expect("UTF-8");
    assert!(text.contains("bvh") && text.contains("exact"), "{text}");
    for (arguments, why) in [
        (&["compare", "five-hertz", "--method", "euler"][..], "euler"),
        (&["compare", "five-hertz", "--rate", "5,0"], "above 0"),
        (&["compare", "five-hertz", "--rate", "1e12"], "1e9 Hz"),
        (&["compare", "five-hertz", "--time", "nan"], "--time"),
        (&["compare", "five-hertz", "--csv", "--json"], "--json"),
    ] {
        let text = refusal(cowbell(arguments), 2);
        assert!(text.contains(why), "{text}");
    }
}

/// Runs a command that must succeed; its array of JSON.
fn json_array(arguments: &[&str]) -> Vec<Value> {
    json(arguments).as_array().cloned().expect("an array")
}

#[test]
fn a_run_is_recorded_and_replayed_to_the_bit() {
    let record = file("hit.run", "");
    let record = record.to_str().expect("UTF-8");
    let hash = answer(&["run", "cube-cow", "--steps", "120", "--hash"]).stdout;
    let hash = String::from_utf8(hash).expect("UTF-8");
    assert_eq!(hash.trim().len(), 16, "{hash}");
    let arguments = [
        "run", "cube-cow", "--steps", "120", "--hash", "--record", record,
    ];
    let recorded = answer(&arguments);
    assert_eq!(recorded.status.code(), Some(0));
    assert_eq!(String::from_utf8_lossy(&recorded.stdout), hash);
    let text = answer(&["replay", record, "--verify"]);
    assert_eq!(text.status.code(), Some(0));
    let text = String::from_utf8(text.stdout).expect("UTF-8");
    assert!(
        text.contains("120 of 120 steps") && text.contains(hash.trim()),
        "{text}"
    );

    // Another state, on the way.
    let whole = fs::read_to_string(record).expect("it was written");
    let line = whole
        .lines()
        .position(|line| line.starts_with("hashes"))
        .expect("hashes")
        + 51;
    let lines: Vec<String> = whole.lines().map(str::to_owned).collect();
    let mut other = lines.clone();
    other[line] = "0123456789abcdef".to_owned();
    fs::write(record, other.join("\n")).expect("written");
    let text = refusal(cowbell(&["replay", record, "--verify"]), 1);
    assert!(text.contains("step 50,"), "{text}");

    for (from, to, why) in [
        ("cowbell-run = 1", "cowbell-run = 9", "this program reads 1"),
        ("cowbell-run = 1", "cowbell-run = =", "line 2"),
        ("name = \"cube-cow\"", "nam = 3", "nam"),
        ("mesh = ", "mush = ", "mush"),
    ] {
        assert!(whole.contains(from), "{from}");
        fs::write(record, whole.replacen(from, to, 1)).expect("written");
        let text = refusal(cowbell(&["replay", record, "--verify"]), 2);
        assert!(text.contains(why) && text.contains("hit.run"), "{text}");
    }
    other[line] = "xyz".to_owned();
    fs::write(record, other.join("\n")).expect("written");
    let text = refusal(cowbell(&["replay", record, "--verify"]), 2);
    assert!(text.contains("`xyz`"), "{text}");
    fs::remove_file(record).expect("removed");
    for (arguments, why) in [
        (&["replay", "no-such.run", "--verify"][..], "no-such.run"),
        (&["run", "parabola", "--record", "a.txt"], ".run"),
        (&["run", "parabola", "--hash", "--json"], "--json"),
    ] {
        let text = refusal(cowbell(arguments), 2);
        assert!(text.contains(why), "{text}");
    }
}

#[test]
fn a_mesh_is_a_scene_of_its_own() {
    let cow = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/meshes/cow.obj");
    let state = json(&["run", cow, "--steps", "3", "--json"]);
    assert_eq!(state["bodies"][0]["name"], "cow");
    let text = refusal(cowbell(&["run", "no-such.obj"]), 2);
    assert!(text.contains("no-such.obj"), "{text}");
    let text = refusal(cowbell(&["run", "cow.glb"]), 2);
    assert!(text.contains("glb") || text.contains("glTF"), "{text}");
}

#[test]
fn run_csv_tells_the_cost_of_each_phase() {
    let states = table(&["run", "cube-cow", "--steps", "60", "--csv"]);
    let at = |name: &str| {
        states[0]
            .iter()
            .position(|title| title == name)
            .expect(name)
    };
    let phases = [
        "integrate_s",
        "broad_phase_s",
        "narrow_phase_s",
        "response_s",
    ]
    .map(at);
    for line in &states[2..] {
        let number = |at: usize| line[at].parse::<f64>().expect("a number");
        let parts: f64 = phases.iter().map(|&phase| number(phase)).sum();
        assert!(
            parts > 0.0 && parts <= number(at("step_cost_s")) + 1e-9,
            "{line:?}"
        );
    }
}

#[test]
fn a_scene_becomes_a_moving_picture() {
    let (gif, png) = (file("m.gif", ""), file("m.png", ""));
    for (path, head) in [(&gif, &b"GIF89a"[..]), (&png, b"\x89PNG")] {
        let name = path.to_str().expect("UTF-8");
        let mut command = cowbell(&[
            "gif", "cube-cow", "-o", name, "--time", "0.2", "--from", "0.7", "--size", "120x80",
        ]);
        let output = command.output().expect("the program starts");
        if output.status.code() == Some(3) {
            skip_without_adapter();
            continue;
        }
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{stderr}");
        assert!(text.contains("6 frames of 120 by 80"), "{text}");
        assert!(fs::read(path).expect("written").starts_with(head));
        fs::remove_file(path).expect("removed");
    }
    for (arguments, why) in [
        (&["gif", "cube-cow", "-o", "a.mp4"][..], ".gif or .png"),
        (
            &["gif", "cube-cow", "-o", "a.gif", "--time", "1e9"],
            "too many",
        ),
        (&["gif", "cube-cow", "-o", "a.gif", "--fps", "0"], "1 to 50"),
        (
            &["gif", "cube-cow", "-o", "a.gif", "--select", "dog"],
            "dog",
        ),
    ] {
        let text = refusal(cowbell(arguments), 2);
        assert!(text.contains(why), "{text}");
    }
}

/// A picture that is made is made without a word on stderr, also of the libraries that draw it.
#[cfg(target_os = "linux")]
#[test]
fn pictures_are_drawn_in_silence() {
    let (png, gif) = (file("s.png", ""), file("s.gif", ""));
    for (command, path) in [("shot", png), ("gif", gif)] {
        let name = path.to_str().expect("UTF-8");
        let mut command = cowbell(&[command, "parabola", "-o", name, "--size", "64x64"]);
        if command
            .get_args()
            .next()
            .is_some_and(|first| first == "gif")
        {
            command.args(["--time", "0.1"]);
        }
        command
            .env_remove("XDG_RUNTIME_DIR")
            .env_remove("NODEVICE_SELECT");
        let output = command.output().expect("the program starts");
        if output.status.code() == Some(3) {
            skip_without_adapter();
            continue;
        }
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!((output.status.code(), &*stderr), (Some(0), ""));
        fs::remove_file(path).expect("removed");
    }
}

/// Without a graphics adapter a test of pictures says nothing; where CI has one that is a failure.
fn skip_without_adapter() {
    assert!(
        std::env::var_os("CI").is_none(),
        "there is no graphics adapter: on Debian install mesa-vulkan-drivers"
    );
    println!("skipped: no graphics adapter");
}
