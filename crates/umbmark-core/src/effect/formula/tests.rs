use super::*;
use crate::drive::Robot;
use crate::effect::tests::{column, model_with, probes, seen};
use crate::effect::{Context, Model, ModelError};
use crate::geometry::{LANES, seeded};
use crate::random::Stream;
use program::Function;

/// What a formula acts on, its text, and its parameters with their values.
type Own<'a> = (Target, &'a str, &'a [(&'a str, f64)]);

fn model_of(formulas: &[Own]) -> Model {
    let mut model = Model::new(&Robot::labmate());
    for (i, (target, text, parameters)) in formulas.iter().enumerate() {
        let (names, values): (Vec<&str>, Vec<f64>) = parameters.iter().copied().unzip();
        model.add_formula(Formula::new(&format!("own_{i}"), *target, text, &names).unwrap(), &values).unwrap();
    }
    model
}

/// Both models predict the same, and so do their derivatives by the values that are paired.
fn agree(own: &Model, listed: &Model, pairs: &[(usize, usize)]) {
    let probes = probes();
    let poses = |model: &Model| seen(model, &model.values().collect::<Vec<_>>(), &probes);
    let near = |a: Vec<f64>, b: Vec<f64>| {
        let most = b.iter().fold(1.0_f64, |most, v| most.max(v.abs()));
        assert!(b.iter().any(|v| *v != 0.0));
        for (a, b) in a.iter().zip(&b) {
            assert!((a - b).abs() < 1e-12 * most, "{a} {b}");
        }
    };
    near(poses(own), poses(listed));
    for (i, j) in pairs {
        near(column(own, *i, &probes), column(listed, *j, &probes));
    }
}

#[test]
fn laws_of_the_catalogue_written_as_formulas_replay_the_same_with_the_same_derivatives() {
    let (c, s) = (3e-3, -2e-3);
    agree(
        &model_of(&[(Target::HeadingPerMetre, "c*cos(heading) + s*sin(heading)", &[("c", c), ("s", s)])]),
        &model_with(&[("floor_slope_yaw", "cosine_rad_per_m", c), ("floor_slope_yaw", "sine_rad_per_m", s)]),
        &[(0, 0), (1, 1)],
    );
    let drift: &[(&str, f64)] = &[("d", 4e-3)];
    agree(
        &model_of(&[
            (Target::LeftWheelScale, "-d * distance / 2", drift),
            (Target::RightWheelScale, "d * distance / 2", &[("d", 4e-3)]),
        ]),
        &model_with(&[("diameter_drift", "per_m", 4e-3)]),
        &[],
    );
}

#[test]
fn every_target_does_what_its_law_says() {
    let piece = Context { length: 0.5, turn_rate: -0.3, duration: 2.0, wheel_travel: [0.4, 0.6], ..Context::default() };
    let at = piece.as_believed();
    let believed = WheelTravel { left: 0.4, right: 0.6 };
    let plain = Model::new(&Robot::labmate()).chain().displacement(&at, &believed);
    let moved = |target| {
        let chain = model_of(&[(target, "k", &[("k", 0.01)])]).chain();
        (chain.wheel_travel(&at, &believed), chain.displacement(&at, &believed))
    };
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-15, "{a} {b}");
    near(moved(Target::HeadingPerMetre).1.rotation, plain.rotation + 0.005);
    near(moved(Target::SidewaysPerMetre).1.sideways, plain.sideways + 0.005);
    near(moved(Target::ForwardPerRadian).1.forward, plain.forward + 0.006);
    near(moved(Target::SidewaysPerRadian).1.sideways, plain.sideways + 0.006);
    let seconds = at.duration;
    near(moved(Target::HeadingPerSecond).1.rotation, plain.rotation + 0.01 * seconds);
    near(moved(Target::ForwardPerSecond).1.forward, plain.forward + 0.01 * seconds);
    near(moved(Target::SidewaysPerSecond).1.sideways, plain.sideways + 0.01 * seconds);
    // Nothing is done to a robot that stands.
    let standing = Context { wheel_travel: [0.0; 2], ..piece };
    let turned = model_of(&[(Target::HeadingPerSecond, "k", &[("k", 0.01)])]).chain();
    assert_eq!(turned.displacement(&standing.as_believed(), &WheelTravel::default()).rotation, 0.0);
    near(moved(Target::TurnScale).1.rotation, 1.01 * plain.rotation);
    near(moved(Target::ForwardScale).1.forward, 1.01 * plain.forward);
    near(moved(Target::LeftWheelScale).0.left, 0.404);
    near(moved(Target::LeftWheelScale).0.right, 0.6);
    near(moved(Target::RightWheelScale).0.right, 0.606);
}

/// Variables have the values of the middle of a piece.
#[test]
fn each_variable_is_what_its_name_says() {
    let piece = Context {
        duration: 2.0,
        speed: 0.5,
        turn_rate: 0.1,
        speed_change: [0.2, 0.6],
        turn_rate_change: 1.2,
        wheel_angle: [1.0, 2.0],
        wheel_rotation: [0.2, 0.4],
        distance: 3.0,
        time: 10.0,
        session_distance: 20.0,
        since_turn: 1.0,
        length: 0.5,
        last_turn: -1.0,
        direction: 1.0,
        ..Context::default()
    };
    let at = piece.at_pose(&Pose2::new(4.0, 5.0, 0.3));
    // Half of an arc: a chord of 2 r sin(angle/2), turned by half of the angle; here half of the arc turns by 0.4.
    let motion = Displacement2 { forward: 0.5, sideways: 0.1, rotation: 0.8 };
    let chord = libm::sin(0.2) / 0.2 * 0.5;
    let middle = at.pose().compose(&Pose2::new(
        chord * (0.5 * libm::cos(0.2) - 0.1 * libm::sin(0.2)),
        chord * (0.5 * libm::sin(0.2) + 0.1 * libm::cos(0.2)),
        0.4,
    ));
    let mut told = Vec::new();
    for (name, value) in [
        ("speed", 0.5),
        ("turn_rate", 0.1),
        ("acceleration", 0.2),
        ("turn_acceleration", 0.6),
        ("heading", 0.7),
        ("x", middle.x),
        ("y", middle.y),
        ("wheel_angle_left", 1.1),
        ("wheel_angle_right", 2.2),
        ("distance", 3.25),
        ("time", 11.0),
        ("session_distance", 20.25),
        ("since_turn", 1.25),
        ("last_turn", -1.0),
        ("direction", 1.0),
        ("pi", std::f64::consts::PI),
    ] {
        let program = parser::parse(name, &[]).unwrap();
        assert!((program.evaluate(&[], &at, &motion) - value).abs() < 1e-15, "{name}");
        told.push(name);
    }
    for (i, known) in VARIABLES.iter().enumerate() {
        assert!(known.variable as usize == i && told.contains(&known.name), "{}", known.name);
        // What people read is the unit that is checked; an angle is a plain number.
        let plain = known.unit.replace('²', "^2").replace("rad/", "1/").replace("rad", "");
        assert_eq!(plain, known.dimension.to_string(), "{}", known.name);
    }
}

/// An expression by itself, its text and its value for k = 0.7, heading 0.4.
#[derive(Clone, Debug)]
enum Tree {
    Leaf(&'static str, f64),
    Number(f64),
    Minus(Box<Tree>),
    Two(char, Box<Tree>, Box<Tree>),
    Power(Box<Tree>, i32),
    Function(&'static str, Box<Tree>),
    Pair(&'static str, Box<Tree>, Box<Tree>),
}

impl Tree {
    /// How strongly what it is made of binds: a sum 1, an atom 5.
    fn strength(&self) -> u8 {
        match self {
            Tree::Two('+' | '-', ..) => 1,
            Tree::Two(..) => 2,
            Tree::Minus(_) => 3,
            Tree::Power(..) => 4,
            _ => 5,
        }
    }

    /// Its text with as few parentheses as the rules of arithmetic ask for, where this part has to bind so strongly.
    fn text(&self, least: u8) -> String {
        let text = match self {
            Tree::Leaf(name, _) => (*name).to_owned(),
            Tree::Number(value) => format!("{value:?}"),
            Tree::Minus(of) => format!("-{}", of.text(3)),
            Tree::Two(sign, a, b) => {
                let strength = self.strength();
                format!("{} {sign} {}", a.text(strength), b.text(strength + 1))
            }
            Tree::Power(of, n) => format!("{}^{n}", of.text(5)),
            Tree::Function(name, of) => format!("{name}({})", of.text(1)),
            Tree::Pair(name, a, b) => format!("{name}({},{})", a.text(1), b.text(1)),
        };
        if self.strength() < least { format!("({text})") } else { text }
    }

    fn value(&self) -> f64 {
        match self {
            Tree::Leaf(_, value) | Tree::Number(value) => *value,
            Tree::Minus(of) => -of.value(),
            Tree::Two('+', a, b) => a.value() + b.value(),
            Tree::Two('-', a, b) => a.value() - b.value(),
            Tree::Two('*', a, b) => a.value() * b.value(),
            Tree::Two(_, a, b) => a.value() / b.value(),
            Tree::Power(of, n) => of.value().powi(*n),
            Tree::Function(name, of) => {
                let x = of.value();
                match *name {
                    "sin" => libm::sin(x),
                    "cos" => libm::cos(x),
                    "tan" => libm::tan(x),
                    "exp" => libm::exp(x),
                    "log" => libm::log(x),
                    "sqrt" => libm::sqrt(x),
                    "abs" => x.abs(),
                    "sign" => {
                        if x == 0.0 {
                            0.0
                        } else {
                            x.signum()
                        }
                    }
                    _ => libm::tanh(x),
                }
            }
            Tree::Pair("min", a, b) => a.value().min(b.value()),
            Tree::Pair(_, a, b) => a.value().max(b.value()),
        }
    }
}

/// A tree at random, not deeper than `depth`.
fn tree(stream: &mut Stream, depth: u32) -> Tree {
    let below = |stream: &mut Stream| Box::new(tree(stream, depth - 1));
    let kind = if depth == 0 { pick(stream, 4) } else { pick(stream, 12) };
    match kind {
        0 => Tree::Leaf("k", 0.7),
        1 => Tree::Leaf("heading", 0.4),
        2 => Tree::Leaf("pi", std::f64::consts::PI),
        3 => Tree::Number([0.0, 1.0, 2.0, 1e-4, 9.0 * stream.uniform()][pick(stream, 5)]),
        4 => Tree::Minus(below(stream)),
        5 => Tree::Power(below(stream), pick(stream, 7) as i32 - 3),
        6 => Tree::Function(Function::ALL[pick(stream, 9)].0, below(stream)),
        7 => Tree::Pair(["min", "max"][pick(stream, 2)], below(stream), below(stream)),
        _ => Tree::Two(['+', '-', '*', '/'][pick(stream, 4)], below(stream), below(stream)),
    }
}

/// At the origin with this heading.
fn headed(heading: f64) -> Context {
    Context { believed_heading: heading, ..Context::default() }
}

/// No motion.
fn still<T: Real>() -> Displacement2<T> {
    Displacement2 { forward: T::from(0.0), sideways: T::from(0.0), rotation: T::from(0.0) }
}

fn pick(stream: &mut Stream, count: usize) -> usize {
    (stream.uniform() * count as f64) as usize
}

/// Random trees, each with its text and program.
fn trees(seed: u64) -> impl Iterator<Item = (Tree, String, Program)> {
    let mut stream = Stream::new(seed, 0, 0);
    (0..20_000).map(move |_| {
        let tree = tree(&mut stream, 5);
        let text = tree.text(1);
        let program = parser::parse(&text, &["k"]).unwrap();
        (tree, text, program)
    })
}

#[test]
fn a_formula_has_the_value_of_the_tree_that_it_was_written_from() {
    let mut compared = 0;
    for (tree, text, program) in trees(1) {
        let (mut largest, mut steepest) = (0.0_f64, 0.0_f64);
        let [k, heading] = [0.7, 0.4].map(|value| Dual { eps: [1.0; LANES], re: value });
        let pose = Pose2::new(Dual::from(0.0), Dual::from(0.0), heading);
        program.watched(&[k], &Context::default().at_pose(&pose), &still(), |_, part| {
            // Sums keep what is no number.
            largest += part.re.abs();
            steepest += part.eps[0].abs();
        });
        let (value, expected) = (program.evaluate(&[0.7], &headed(0.4).as_believed(), &still()), tree.value());
        // Where a part is huge or steep, rounding decides: nothing is compared.
        if largest < 1e3 && steepest < 1e3 {
            compared += 1;
            assert!((value - expected).abs() < 1e-9, "{text}: {value} {expected}");
        }
    }
    assert!(compared > 12_000, "{compared}");
}

#[test]
fn derivatives_are_those_of_finite_differences() {
    let mut compared = 0;
    for (_, text, program) in trees(2) {
        // Where a part is huge, rounding decides.
        let mut tame = true;
        program.watched(&[0.7], &headed(0.4).as_believed(), &still(), |_, part: f64| tame &= part.abs() < 1e6);
        let at = |k: f64| program.evaluate(&[k], &headed(0.4).as_believed(), &still());
        let nowhere = Context::default();
        let here = nowhere.at_pose(&Pose2::new(0.0, 0.0, 0.4).lift());
        let dual = program.evaluate(&seeded([0.7], &[0]), &here, &still());
        assert!(!tame || (dual.re - at(0.7)).abs() <= 1e-7 * (1.0 + at(0.7).abs()), "{text}: {} {}", dual.re, at(0.7));
        let numeric = |h: f64| (at(0.7 + h) - at(0.7 - h)) / (2.0 * h);
        let (fine, coarse) = (numeric(1e-5), numeric(2e-5));
        // Where the two steps differ there is a corner or a pole near.
        if tame
            && fine != 0.0
            && (fine - coarse).abs() < 1e-6 * (1.0 + fine.abs())
            && fine.abs().max(at(0.7).abs()) < 1e4
        {
            compared += 1;
            assert!((dual.eps[0] - fine).abs() < 1e-5 * (1.0 + fine.abs()), "{text}: {} {fine}", dual.eps[0]);
        }
    }
    assert!(compared > 5_000, "{compared}");
}

#[test]
fn no_text_makes_the_parser_panic() {
    let mut stream = Stream::new(3, 0, 0);
    let words =
        ["+", "-", "*", "/", "^", "(", ")", ",", ".", " ", "k", "sin", "max", "2", "1e", "é", "speed", "\n", "1e-"];
    for _ in 0..50_000 {
        let count = pick(&mut stream, 12);
        let text: String = (0..count).map(|_| words[pick(&mut stream, words.len())]).collect();
        let _ = Formula::new("own", Target::ForwardScale, &text, &["k"]);
    }
}

#[test]
fn signs_powers_and_order_are_those_of_arithmetic() {
    for (text, value) in [
        ("-2^2", -4.0),
        ("2^-2", 0.25),
        ("2^(-2)", 0.25),
        ("2 - 3 - 4", -5.0),
        ("16 / 4 / 2", 2.0),
        ("2 * -3", -6.0),
        ("--2", 2.0),
        ("2 - -3", 5.0),
        ("1 + 2 * 3^2", 19.0),
        ("1.5e2 + .5 + 1.", 151.5),
        ("0^0", 1.0),
        ("max(1, min(5, 3))", 3.0),
        ("sign(-3) + sign(0) + abs(-2)", 1.0),
    ] {
        let program = parser::parse(text, &[]).unwrap();
        assert_eq!(program.evaluate(&[], &headed(0.0).as_believed(), &still()), value, "{text}");
    }
}

#[test]
fn what_cannot_be_meant_is_refused_with_its_column() {
    for (text, said) in [
        ("k * spede", "column 5: there is no \"spede\"; did you mean \"speed\"?"),
        ("k * sin(hedding)", "column 9: there is no \"hedding\"; did you mean \"heading\"?"),
        ("k *", "column 4: expected a number, a name or \"(\", got the end"),
        ("k * (1 + 2", "column 11: expected an operator or \")\", got the end"),
        ("k 2", "column 3: expected an operator or the end, got \"2\""),
        ("k)", "column 2: expected an operator or the end, got \")\""),
        ("", "column 1: expected a number, a name or \"(\", got the end"),
        ("é + k", "column 1: 'é' means nothing here; a formula has + - * / ^ ( ) , numbers and names"),
        ("k + 1e999", "column 5: expected a finite number, got \"1e999\""),
        ("k + .", "column 5: expected a finite number, got \".\""),
        ("k ** 2", "column 4: expected a number, a name or \"(\", got \"*\""),
        ("k^0.5", "column 3: expected a whole number from -16 to 16 after \"^\" (sqrt takes roots), got \"0.5\""),
        (
            "k^heading",
            "column 3: expected a whole number from -16 to 16 after \"^\" (sqrt takes roots), got \"heading\"",
        ),
        ("k^2^3", "column 4: expected parentheses round the power that is raised again, got \"^\""),
        ("sin", "column 1: \"sin\" is a function: it takes 1 argument in parentheses"),
        ("k * min(heading)", "column 5: \"min\" takes 2 arguments, got 1"),
        ("k * sin()", "column 5: \"sin\" takes 1 argument, got 0"),
        ("k * sin(1, 2)", "column 5: \"sin\" takes 1 argument, got 2"),
        ("k(2)", "column 1: \"k\" is not a function; write * to multiply"),
        ("heading", "the parameter k does not occur in the formula; take it away"),
    ] {
        let error = Formula::new("own", Target::ForwardScale, text, &["k"]).unwrap_err().to_string();
        assert_eq!(error, said, "{text}");
    }
    let unknown = Formula::new("own", Target::ForwardScale, "zzzzzz", &[]).unwrap_err().to_string();
    assert!(unknown.starts_with("column 1: there is no \"zzzzzz\"; name it among the parameters, or use speed"));
    assert!(VARIABLES.iter().all(|known| unknown.contains(&format!(" {},", known.name))));
    assert!(Function::ALL.iter().all(|(name, _)| unknown.contains(name)));
}

#[test]
fn a_formula_without_end_is_refused_and_the_longest_one_is_not() {
    let sum = |terms: usize| vec!["k"; terms].join("+");
    let nested = |depth: usize| format!("{}k{}", "(".repeat(depth), ")".repeat(depth));
    let compile = |text: &str| Formula::new("own", Target::ForwardScale, text, &["k"]);
    assert!(compile(&sum(128)).is_ok() && compile(&nested(15)).is_ok());
    for text in [sum(129), nested(16), nested(100_000), format!("{}k", "-".repeat(100_000))] {
        assert!(matches!(compile(&text), Err(FormulaError::TooLong { .. })));
    }
}

#[test]
fn names_are_letters_and_nobody_elses() {
    let new = |name: &str, parameters: &[&str]| {
        let text = if parameters.is_empty() { "1".into() } else { parameters.join(" + ") };
        Formula::new(name, Target::ForwardScale, &text, parameters).map(|_| ()).map_err(|e| e.to_string())
    };
    assert_eq!(new("own", &["a", "b", "c", "d", "e", "f"]), Ok(()));
    for (name, parameters, said) in [
        ("own", &["a", "b", "c", "d", "e", "f", "g"][..], "an effect has 6 parameters at most, got 7"),
        ("scale", &[], "\"scale\" cannot be the name of an effect: the catalogue has an effect of this name"),
        (
            "a b",
            &[],
            "\"a b\" cannot be the name of an effect: it takes letters, digits and _, and begins with a letter",
        ),
        ("own", &["speed"], "\"speed\" cannot be the name of a parameter: it has a meaning in every formula"),
        ("own", &["x"], "\"x\" cannot be the name of a parameter: it has a meaning in every formula"),
        ("own", &["a", "y"], "\"y\" cannot be the name of a parameter: it has a meaning in every formula"),
        ("own", &["sin"], "\"sin\" cannot be the name of a parameter: it has a meaning in every formula"),
        ("own", &["a", "a"], "\"a\" cannot be the name of a parameter: another one has it"),
    ] {
        assert_eq!(new(name, parameters), Err(said.to_owned()));
    }
}

#[test]
fn units_that_do_not_agree_are_refused_with_both_sides() {
    let compile = |text: &str| Formula::new("own", Target::HeadingPerMetre, text, &["k"]).map_err(|e| e.to_string());
    for (text, said) in [
        ("k * (distance + time)", "column 17: \"distance\" is in m and \"time\" in s: they do not add up or compare"),
        (
            "k * max(speed^2, acceleration)",
            "column 18: \"speed^2\" is in m^2/s^2 and \"acceleration\" in m/s^2: they do not add up or compare",
        ),
        (
            "k * sin(distance)",
            "column 9: sin takes a plain number or an angle, and \"distance\" is in m; divide it by a parameter of that unit",
        ),
        (
            "k * exp(-time)",
            "column 9: exp takes a plain number or an angle, and \"-time\" is in s; divide it by a parameter of that unit",
        ),
        (
            "sin(k / time) * speed",
            "the formula is in m/s, and heading_per_metre in 1/m; multiply it by a parameter, which then has the unit that is missing",
        ),
        (
            "sin(k * distance) * k + k * k",
            "column 25: \"sin(k * distance) * k\" is in 1/m and \"k * k\" in 1/m^2: they do not add up or compare",
        ),
    ] {
        assert_eq!(compile(text).unwrap_err(), said, "{text}");
    }
    for (text, unit) in [
        ("k * sin(heading)", "1/m"),
        ("sin(distance / k) / since_turn", "m"),
        ("k * speed^2", "s^2/m^3"),
        ("k * sqrt(distance)", "1/m^1.5"),
        ("k * max(since_turn, 0.01)", "1/m^2"),
        ("k * tanh(speed / 0.2)", "1/m"),
        ("0.001 * cos(heading - k)", ""),
        ("2 * k * sin(heading)", ""),
    ] {
        assert_eq!(compile(text).unwrap().parameters()[0].unit, unit, "{text}");
    }
}

#[test]
fn a_place_where_a_formula_is_no_number_is_named_with_what_is_there() {
    let piece = Context { time: 3.0, length: 0.0, since_turn: 0.0, run: 2.0, ..Context::default() };
    let at = piece.as_believed();
    let check = |target, text: &str, k: f64, at: &Here| {
        model_of(&[(target, text, &[("k", k)])]).check_along([*at]).map_err(|error| error.to_string())
    };
    let said = "own_0: \"k / since_turn\", or its derivative, is not finite 3.00 s after START in run 2, where k = 0.001, \
                since_turn = 0 m; change the formula so that it is finite there too, for instance a / max(b, 0.01) instead \
                of a / b";
    assert_eq!(check(Target::ForwardScale, "2 + k / since_turn", 1e-3, &at), Err(said.to_owned()));
    assert_eq!(check(Target::ForwardScale, "k / max(since_turn, 0.01)", 1e-3, &at), Ok(()));
    assert_eq!(check(Target::HeadingPerMetre, "k / since_turn", 1e-3, &at), Ok(()), "nothing is driven there");
    assert!(check(Target::ForwardScale, "sqrt(k)", 0.0, &at).is_err(), "the derivative is infinite");
    assert!(check(Target::ForwardScale, "k * sqrt(heading)", 1.0, &at).is_err(), "that by the heading is");
    assert!(check(Target::ForwardScale, "log(k - 1)", 0.5, &at).is_err());
    // The derivatives by x and by y, where the formula has them.
    let place = |x: f64, y: f64| piece.at_pose(&Pose2::new(x, y, 0.5));
    let there = place(2.0, 1.0);
    for (name, here) in [("x", place(0.0, 1.0)), ("y", place(2.0, 0.0))] {
        let text = format!("k * sqrt({name})");
        let said = check(Target::ForwardScale, &text, 1.0, &here).unwrap_err();
        assert!(said.contains(&format!("\"sqrt({name})\"")) && said.contains(&format!("{name} = 0 m;")), "{said}");
        assert_eq!(check(Target::ForwardScale, &text, 1.0, &there), Ok(()));
        assert_eq!(check(Target::ForwardScale, "k * heading", 1.0, &here), Ok(()));
    }
    assert!(check(Target::ForwardScale, "k * sqrt(x - y)", 1.0, &place(2.0, 2.0)).is_err());
    // With as many parameters as there may be, every derivative is looked at.
    for (name, here) in [("x", place(0.0, 1.0)), ("y", place(2.0, 0.0))] {
        let text = format!("a + b + c + d + e + f * sqrt({name})");
        let all = ["a", "b", "c", "d", "e", "f"].map(|name| (name, 1.0));
        let model = model_of(&[(Target::ForwardScale, &text, &all)]);
        assert!(model.check_along([there]).is_ok() && model.check_along([here]).is_err(), "{name}");
    }
    assert_eq!(check(Target::ForwardScale, "k * sqrt(speed)", 1.0, &at), Ok(()));
}

#[test]
fn sizes_are_what_a_formula_is_linear_in() {
    for (text, sizes) in [
        ("k * sin(heading - h)", [true, false]),
        ("k * exp(-distance / h)", [true, false]),
        ("k + h * speed", [true, true]),
        ("tanh(k * h)", [true, true]),
        ("speed * -k / (heading + h^2)", [true, false]),
        ("k^1 * h^2", [true, false]),
    ] {
        let program = parser::parse(text, &["k", "h"]).unwrap();
        let found: Vec<bool> = program.roles(2).iter().map(|role| *role == Role::Size).collect();
        assert_eq!(found, sizes, "{text}");
    }
    let mut model = model_of(&[(Target::HeadingPerMetre, "k * sin(heading - h)", &[("k", 1e-3), ("h", 0.5)])]);
    model.add("wheelbase").unwrap();
    assert_eq!(model.shapes(), [2], "the wheelbase stands before it");
}

#[test]
fn a_model_keeps_formulas_apart_from_the_catalogue_and_from_each_other() {
    let own = |text: &str| Formula::new("own", Target::ForwardScale, text, &["k"]).unwrap();
    let mut model = Model::new(&Robot::labmate());
    model.add_formula(own("k"), &[0.25]).unwrap();
    assert_eq!(model.add_formula(own("2*k"), &[0.0]).unwrap_err(), ModelError::Taken { name: "own" });
    assert!(matches!(
        Model::new(&Robot::labmate()).add_formula(own("k"), &[]),
        Err(ModelError::Values { parameters: 1, values: 0, .. })
    ));
    assert!(Model::new(&Robot::labmate()).add_formula(own("k"), &[f64::NAN]).is_err());
    model.set("own", "k", 0.5).unwrap();
    assert_eq!((model.get("own", "k"), model.add("own").unwrap().values[0]), (Some(0.5), 0.5));
    assert!(model.set("own", "q", 0.5).is_err());
    model.add("marker_yaw").unwrap();
    assert_eq!(model.parts().iter().map(|part| part.effect.name()).collect::<Vec<_>>(), ["marker_yaw", "own"]);
    assert!(model.varies());
    assert_eq!(model.at_rest(), model);
    assert_ne!(own("k"), own("2*k"));
}
