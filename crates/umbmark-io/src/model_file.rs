//! `model.toml`: effects with their values, fixed or drawn.

use super::distribution_table::{DISTRIBUTIONS, read_distribution};
use super::document::{Entry, Source, Table};
use super::error::{DatasetError, LineProblem, did_you_mean};
use super::robot_file::read_robot_table;
use super::source::read_text;
use umbmark_core::drive::Robot;
use umbmark_core::effect::{CATALOGUE, CONVERTED, Conversion, Entry as Effect, Formula, FormulaError, Model, Target};
use umbmark_core::likelihood::Noise;
use umbmark_core::monte_carlo::{Distribution, Draw};
use umbmark_core::parameter::Parameter;

/// Keys of an effect of the user's own, those first that no other has.
const OWN: [&str; 6] = ["acts_on", "formula", "parameters", "name", "free", "fixed"];

/// What is missing in a model of nobody.
const WHOSE: &str =
    "a table [robot] as in robot.toml, the nominal robot that the numbers belong to (learnt and fitted models have it)";

/// What a `model.toml` says.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelFile {
    /// The effects, of the robot that was asked for. A parameter that is drawn has the middle of its distribution.
    pub model: Model,
    /// The parameters that are drawn.
    pub draws: Vec<Draw>,
    /// What was changed where the file has another nominal robot.
    pub conversion: Option<Conversion>,
    /// The sizes of the noise, where they were fitted.
    pub noise: Option<Noise>,
    /// What speaks against using it, as the verb said that wrote it.
    pub doubt: Option<Doubt>,
}

/// What speaks against using a model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Doubt {
    /// In a sentence or more.
    pub because: String,
    /// Whether it holds only for the numbers of the robot without the other effects.
    pub alone: bool,
}

impl ModelFile {
    /// Reads a `model.toml` for a robot; for the file's own, and else the LabMate, where none is given.
    pub fn read(file: impl AsRef<std::path::Path>, robot: Option<&Robot>) -> Result<ModelFile, DatasetError> {
        let file = file.as_ref();
        ModelFile::parse(&file.display().to_string(), &read_text(file)?, robot)
    }

    /// Reads a `model.toml` that has to say which nominal robot it is of.
    pub fn read_with_robot(file: impl AsRef<std::path::Path>) -> Result<ModelFile, DatasetError> {
        let file = file.as_ref();
        let (name, text) = (file.display().to_string(), read_text(file)?);
        let source = Source { file: &name, text: &text };
        Table::root(&source, &source.parse()?).need("robot", WHOSE)?;
        ModelFile::parse(&name, &text, None)
    }

    /// The same from text; `file` is what messages call it.
    ///
    /// ```
    /// use umbmark_core::drive::Robot;
    /// use umbmark_io::ModelFile;
    /// let text = "[[effect]]\nname = \"wheelbase\"\ne_b = { mean = 1.01, sd = 0.002 }\nfree = true\n";
    /// let ModelFile { model, draws, .. } = ModelFile::parse("model.toml", text, Some(&Robot::labmate()))?;
    /// assert_eq!(model.get("wheelbase", "e_b"), Some(1.01));
    /// assert!(model.parts()[0].free && draws.len() == 1);
    /// # Ok::<(), umbmark_io::DatasetError>(())
    /// ```
    pub fn parse(file: &str, text: &str, robot: Option<&Robot>) -> Result<ModelFile, DatasetError> {
        let source = Source { file, text };
        let root = source.parse()?;
        let root = Table::root(&source, &root);
        root.only(&["robot", "effect", "noise", "doubt"])?;
        let made_for = root.get("robot").map(|entry| read_robot_table(&entry.table("[robot]".into())?)).transpose()?;
        let own = made_for.as_ref().or(robot).cloned().unwrap_or_else(Robot::labmate);
        let (model, draws) = read_effects(&root, &own)?;
        let noise = root.get("noise").map(|entry| read_noise(&entry.table("[noise]".into())?)).transpose()?;
        let doubt = root.get("doubt").map(|entry| read_doubt(&entry.table("[doubt]".into())?)).transpose()?;
        let (Some(robot), Some(entry)) = (robot, root.get("robot")) else {
            return Ok(ModelFile { model, draws, conversion: None, noise, doubt });
        };
        let refuse = |reason: &str| entry.wrong("the nominal robot that the model is used for", reason);
        let (model, conversion) = model.converted(robot).map_err(|error| refuse(&error.to_string()))?;
        let drawn = draws.iter().any(|draw| CONVERTED.contains(&draw.effect()));
        match conversion {
            Some(_) if drawn => Err(refuse("E_d, E_b or E_s is drawn, and distributions are not converted")),
            _ => Ok(ModelFile { model, draws, conversion, noise, doubt }),
        }
    }
}

/// What speaks against the model.
fn read_doubt(table: &Table) -> Result<Doubt, DatasetError> {
    table.only(&["because", "alone"])?;
    let because = table.need("because", "the reason, in words")?.word("a text")?.to_owned();
    let alone = table.get("alone").map(|entry| entry.flag()).transpose()?.unwrap_or(false);
    Ok(Doubt { because, alone })
}

/// The sizes of the noise; what is not given is 0.
fn read_noise(table: &Table) -> Result<Noise, DatasetError> {
    table.only(&Noise::WRITTEN.each_ref().map(|size| size.name))?;
    let mut sizes = [0.0; Noise::WRITTEN.len()];
    for (value, size) in sizes.iter_mut().zip(&Noise::WRITTEN) {
        if let Some(entry) = table.get(size.name) {
            *value = entry.number(size)?;
        }
    }
    Ok(Noise::of_written(sizes))
}

/// The effects of a file on a robot, and those of their parameters that are drawn.
fn read_effects(root: &Table, robot: &Robot) -> Result<(Model, Vec<Draw>), DatasetError> {
    let mut model = Model::new(robot);
    let mut draws = Vec::new();
    let mut names: Vec<Entry> = Vec::new();
    let Some(effects) = root.get("effect") else { return Ok((model, draws)) };
    for effect in effects.list("a list of tables, each headed [[effect]]")? {
        let table = effect.table("[[effect]]".into())?;
        let name = table.get("name").ok_or_else(|| table.refuse(LineProblem::NoEffectName))?;
        let same = |other: &&Entry| other.word("").ok() == name.word("").ok();
        if let Some(first) = names.iter().find(same) {
            return Err(first.again(&name));
        }
        names.push(name);
        if OWN[..3].iter().any(|key| table.get(key).is_some()) {
            add_own(&mut model, &name, &table)?;
        } else {
            add(&mut model, &mut draws, find(&name)?, &table)?;
        }
    }
    Ok((model, draws))
}

fn find(name: &Entry) -> Result<&'static Effect, DatasetError> {
    let word = name.word("the name of an effect")?;
    if let Some(entry) = CATALOGUE.iter().find(|entry| entry.about.name == word) {
        return Ok(entry);
    }
    let near = did_you_mean(word, CATALOGUE.iter().map(|entry| entry.about.name));
    Err(match near.is_empty() {
        true => name.refuse(LineProblem::UnknownEffect { name: name.shown() }),
        false => name.wrong("the name of an effect", &near),
    })
}

fn add(model: &mut Model, draws: &mut Vec<Draw>, effect: &Effect, table: &Table) -> Result<(), DatasetError> {
    let about = &effect.about;
    let mut keys = vec!["name", "free", "fixed"];
    keys.extend(about.parameters.iter().map(|p| p.name));
    table.only(&keys)?;
    let mut values = Vec::new();
    for parameter in about.parameters {
        let Some(entry) = table.get(parameter.name) else { continue };
        let (value, distribution) = read_value(&entry, parameter)?;
        values.push((parameter.name, value));
        if let Some(distribution) = distribution {
            let draw = Draw::new(about.name, parameter.name, distribution);
            draws.push(draw.map_err(|error| entry.wrong(DISTRIBUTIONS, &error.to_string()))?);
        }
    }
    let free = table.get("free").map_or(Ok(false), |entry| entry.flag())?;
    let impossible = |error: umbmark_core::effect::ModelError| table.missing("possible values", &error.to_string());
    model.add(about.name).map_err(impossible)?.free = free;
    values.into_iter().try_for_each(|(name, value)| model.set(about.name, name, value)).map_err(impossible)?;
    fix(model, about.name, table)
}

/// Fixes the parameters that an effect names.
fn fix(model: &mut Model, effect: &str, table: &Table) -> Result<(), DatasetError> {
    let Some(entry) = table.get("fixed") else { return Ok(()) };
    let allowed = "a list of parameters that fits do not change, e.g. [\"drift_y\"]";
    entry.list(allowed)?.iter().try_for_each(|name| {
        let fixed = model.fix(effect, name.word(allowed)?);
        fixed.map_err(|error| name.wrong("a parameter of the effect", &error.to_string()))
    })
}

/// Adds an effect of the user's own.
fn add_own(model: &mut Model, name: &Entry, table: &Table) -> Result<(), DatasetError> {
    table.only(&OWN)?;
    let (acts_on, text) = (
        table.need("acts_on", "e.g. acts_on = \"heading_per_metre\"")?,
        table.need("formula", "e.g. formula = \"k * sin(heading)\"")?,
    );
    let target = read_target(&acts_on)?;
    let parameters = table.get("parameters");
    let numbers = parameters.map_or(Ok(Vec::new()), |entry| read_parameters(&entry))?;
    let names: Vec<&str> = numbers.iter().map(|(name, _)| *name).collect();
    let values: Vec<f64> = numbers.iter().map(|(_, value)| *value).collect();
    let word = text.word("a formula, e.g. \"k * sin(heading)\"")?;
    let formula = Formula::new(name.word("the name of an effect")?, target, word, &names);
    let formula = formula.map_err(|error| match (&error, parameters) {
        (FormulaError::Naming { what: "an effect", .. }, _) => name.wrong("a name of its own", &error.to_string()),
        (
            FormulaError::Naming { .. } | FormulaError::Unused { .. } | FormulaError::TooManyParameters { .. },
            Some(entry),
        ) => entry.wrong("the formula's own", &error.to_string()),
        _ => text.wrong("one that can be evaluated", &error.to_string()),
    })?;
    let free = table.get("free").map_or(Ok(false), |entry| entry.flag())?;
    let impossible = |error: umbmark_core::effect::ModelError| table.missing("possible values", &error.to_string());
    let effect = formula.name();
    model.add_formula(formula, &values).map_err(impossible)?.free = free;
    fix(model, effect, table)
}

fn read_target(entry: &Entry) -> Result<Target, DatasetError> {
    let names = Target::ALL.map(Target::name);
    let allowed = format!("one of {}", names.join(", "));
    let word = entry.word(&allowed)?;
    let target = Target::ALL.into_iter().find(|target| target.name() == word);
    target.ok_or_else(|| entry.wrong(&allowed, &did_you_mean(word, names)))
}

/// Names and start values of the parameters of a formula.
fn read_parameters<'a>(entry: &Entry<'a>) -> Result<Vec<(&'a str, f64)>, DatasetError> {
    if !entry.is_table() {
        return Err(entry.wrong("a table of start values, e.g. { k = 0.0 }", ""));
    }
    let number = |start: Entry<'a>| {
        let value = start.any_number().filter(|value| value.is_finite());
        let wrong = || start.wrong("a finite number, its start value", "");
        value.map(|value| (start.key, value)).ok_or_else(wrong)
    };
    entry.table("parameters".into())?.entries().into_iter().map(number).collect()
}

/// The value of a parameter, or the middle of its distribution and the distribution.
fn read_value(entry: &Entry, parameter: &Parameter) -> Result<(f64, Option<Distribution>), DatasetError> {
    if !entry.is_table() {
        return Ok((entry.number(parameter)?, None));
    }
    if !parameter.choices().is_empty() {
        return Err(entry.wrong(&parameter.allowed(), "it cannot be drawn"));
    }
    let distribution = read_distribution(&entry.table(entry.key.to_owned())?, parameter, &[])?;
    Ok((distribution.centre(), Some(distribution)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<(Model, Vec<Draw>), DatasetError> {
        let ModelFile { model, draws, .. } = ModelFile::parse("model.toml", text, Some(&Robot::labmate()))?;
        Ok((model, draws))
    }

    #[test]
    fn a_model_of_another_robot_is_converted_or_refused() {
        let robot = |wheelbase| {
            format!("[robot]\nwheelbase_m = {wheelbase}\nwheel_diameter_m = 0.15\nticks_per_revolution = 2000\n")
        };
        let effects = "[[effect]]\nname = \"wheelbase\"\ne_b = 1.01\n";
        let here = Robot::labmate();
        let of = |text: &str| ModelFile::parse("model.toml", text, Some(&here));
        let own = of(&(robot("0.34") + effects)).unwrap();
        assert_eq!((own.model.get("wheelbase", "e_b"), own.conversion), (Some(1.01), None));
        let far = of(&(robot("0.17") + effects)).unwrap();
        assert_eq!((far.model.get("wheelbase", "e_b"), far.model.robot()), (Some(0.505), &here));
        assert_eq!(
            far.conversion.unwrap().to_string(),
            "was made for a robot with wheelbase_m = 0.17, which is 0.34 here; converted: E_d 1.000000 is now 1.000000, E_b 1.010000 \
             is 0.505000 and E_s 1.000000 is 1.000000"
        );
        let refused = |text: String| of(&text).unwrap_err().to_string();
        let drawn = robot("0.33") + "[[effect]]\nname = \"wheelbase\"\ne_b = { mean = 1.01, sd = 0.002 }\n";
        assert!(refused(drawn).ends_with("E_d, E_b or E_s is drawn, and distributions are not converted"));
        let slip = robot("0.17") + "[[effect]]\nname = \"speed_slip\"\n";
        assert!(refused(slip).contains("depend on speed, way or wheel angle, which differ too much; learn it anew"));
        let crab = robot("0.335") + "[[effect]]\nname = \"crab\"\nangle_rad = 0.01\n";
        assert!(
            of(&crab).unwrap().conversion.unwrap().to_string().ends_with("; crab stayed as before, right to 1.5 %")
        );
        let without = ModelFile::parse("model.toml", &(robot("0.17") + effects), None).unwrap();
        assert_eq!((without.model.robot().drive.wheelbase(), without.conversion), (0.17, None));
    }

    #[test]
    fn noise_that_is_not_given_is_none_and_a_size_out_of_range_is_refused() {
        let of = |lines: &str| ModelFile::parse("model.toml", &format!("[noise]\n{lines}\n"), None);
        let noise = of("forward_m_per_sqrt_m = 2e-4").unwrap().noise.unwrap();
        assert_eq!((noise.forward_per_metre, noise.heading_per_metre, noise.within_position), (2e-4, 0.0, 0.0));
        assert_eq!(ModelFile::parse("model.toml", "", None).unwrap().noise, None);
        for (line, said) in [
            ("forward_m_per_sqrt_m = -1e-4", "forward_m_per_sqrt_m must be between 0 and 10 m/√m, got -1e-4"),
            ("reference_time_s = nan", "reference_time_s must be between 0 and 10 s, got nan"),
            (
                "heading_rad_per_sqrtm = 1e-3",
                "unknown key \"heading_rad_per_sqrtm\" in [noise]; did you mean \"heading_rad_per_sqrt_m\"?",
            ),
        ] {
            assert_eq!(of(line).unwrap_err().to_string(), format!("model.toml:2: {said}"));
        }
    }

    #[test]
    fn effects_have_the_values_of_the_file_and_defaults_elsewhere() {
        let text = "[[effect]]\nname = \"wheelbase\"\ne_b = 1.01\nfree = true\n\n\
                    [[effect]]\nname = \"placed_bumps\"\ncount = 10\nprofile = \"edge\"\n";
        let (model, draws) = read(text).unwrap();
        assert_eq!(model.get("wheelbase", "e_b"), Some(1.01));
        assert_eq!(model.get("placed_bumps", "profile"), Some(1.0));
        assert_eq!(model.get("placed_bumps", "height_m"), Some(0.010));
        assert!(draws.is_empty());
        assert_eq!(model.parts().iter().map(|part| part.free).collect::<Vec<_>>(), [true, false]);
        assert!(read("# nothing\n").unwrap().0.parts().is_empty());
    }

    #[test]
    fn parameters_that_are_fixed_are_named_and_written_again() {
        let text = "[[effect]]\nname = \"floor_slope\"\ndrift_x = 0.001\nfree = true\nfixed = [\"drift_y\"]\n\n\
                    [[effect]]\nname = \"own\"\nacts_on = \"heading_per_metre\"\nformula = \"k * sin(heading - h0)\"\n\
                    parameters = { k = 0.25, h0 = 2 }\nfree = true\nfixed = [\"h0\", \"h0\"]\n";
        let (model, _) = read(text).unwrap();
        assert_eq!(model.parts().iter().map(|part| part.fixed.clone()).collect::<Vec<_>>(), [["drift_y"], ["h0"]]);
        let place = |effect, parameter| model.place_of(effect, parameter).unwrap();
        let fixed = [place("floor_slope", "drift_y"), place("own", "h0")];
        let free = (0..model.values().count()).filter(|place| !fixed.contains(place));
        assert_eq!(model.free_places(), free.collect::<Vec<_>>());
        assert_eq!(read(&umbmark_core::effect::effects_text(&model)).unwrap().0, model);
        for (line, said) in [
            (
                "fixed = \"e_b\"",
                "3: fixed must be a list of parameters that fits do not change, e.g. [\"drift_y\"], got \"e_b\"",
            ),
            ("fixed = [\"e_d\"]", "wheelbase has no parameter \"e_d\"; did you mean \"e_b\"?"),
            ("fixed = [1]", "got 1"),
        ] {
            let error = read(&format!("[[effect]]\nname = \"wheelbase\"\n{line}\n")).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
    }

    #[test]
    fn a_parameter_may_be_normal_or_uniform_and_stands_at_its_middle() {
        let text = "[[effect]]\nname = \"scale\"\ne_s = { mean = 1.002, sd = 0.0005 }\n\
                    [[effect]]\nname = \"wheelbase\"\ne_b = { min = 0.99, max = 1.03 }\n";
        let (model, draws) = read(text).unwrap();
        assert_eq!(draws[0].distribution(), Distribution::Normal { mean: 1.002, sd: 0.0005 });
        assert_eq!(draws[1].distribution(), Distribution::Uniform { min: 0.99, max: 1.03 });
        assert_eq!((model.get("scale", "e_s"), model.get("wheelbase", "e_b")), (Some(1.002), Some(1.01)));
    }

    #[test]
    fn an_effect_of_ones_own_is_a_formula_with_start_values() {
        let text = "[[effect]]\nname = \"carpet\"\nacts_on = \"heading_per_metre\"\n\
                    formula = \"k * sin(heading - h0)\"\nparameters = { k = 0.25, h0 = 2 }\nfree = true\n";
        let (model, draws) = read(text).unwrap();
        assert_eq!((model.get("carpet", "k"), model.get("carpet", "h0"), draws.len()), (Some(0.25), Some(2.0), 0));
        assert!(model.parts()[0].free);
        let (model, _) = read(&text.replace("{ k = 0.25, h0 = 2 }", "{ h0 = 2, k = 0.25 }")).unwrap();
        assert_eq!(model.values().collect::<Vec<_>>(), [2.0, 0.25], "in the order of the file");
        let none = "[[effect]]\nname = \"push\"\nacts_on = \"forward_scale\"\nformula = \"0.001\"\n";
        assert!(read(none).unwrap().0.parts()[0].values.is_empty());
    }

    #[test]
    fn a_formula_that_cannot_be_meant_is_refused_with_its_line_and_column() {
        let good = [
            ("name", "\"carpet\""),
            ("acts_on", "\"heading_per_metre\""),
            ("formula", "\"k * sin(heading)\""),
            ("parameters", "{ k = 0.0 }"),
        ];
        for (key, value, said) in [
            ("acts_on", "", "1: [[effect]] has no acts_on; add e.g. acts_on = \"heading_per_metre\""),
            (
                "acts_on",
                "\"heading_per_meter\"",
                "3: acts_on must be one of heading_per_metre, forward_scale, turn_scale, sideways_per_metre, \
                 forward_per_radian, sideways_per_radian, heading_per_second, forward_per_second, sideways_per_second, \
                 left_wheel_scale, right_wheel_scale, got \"heading_per_meter\"; \
                 did you mean \"heading_per_metre\"?",
            ),
            ("formula", "", "1: [[effect]] has no formula; add e.g. formula = \"k * sin(heading)\""),
            (
                "formula",
                "3",
                "4: formula must be a formula, e.g. \"k * sin(heading)\", got 3; put it in quotation marks",
            ),
            (
                "formula",
                "\"k * sin(hedding)\"",
                "4: formula must be one that can be evaluated, got \"k * sin(hedding)\"; column 9: there is no \"hedding\"; \
                 did you mean \"heading\"?",
            ),
            (
                "formula",
                "\"k * (time + distance)\"",
                "4: formula must be one that can be evaluated, got \"k * (time + distance)\"; column 13: \"time\" is in s and \
                 \"distance\" in m: they do not add up or compare",
            ),
            (
                "parameters",
                "",
                "4: formula must be one that can be evaluated, got \"k * sin(heading)\"; column 1: there is no \"k\"; name \
                 it among the parameters, or use speed, turn_rate, acceleration, turn_acceleration, heading, wheel_angle_left, wheel_angle_right, \
                 x, y, distance, session_distance, since_turn, time, last_turn, direction, pi and the functions sin, cos, tan, \
                 exp, log, sqrt, abs, sign, min, max, tanh",
            ),
            ("parameters", "[1]", "5: parameters must be a table of start values, e.g. { k = 0.0 }, got [1]"),
            ("parameters", "{ k = \"0\" }", "5: k must be a finite number, its start value, got \"0\""),
            (
                "parameters",
                "{ k = { mean = 0.0, sd = 1.0 } }",
                "5: k must be a finite number, its start value, got { mean = 0.0, sd = 1.0 }",
            ),
            (
                "parameters",
                "{ k = 0.0, q = 1.0 }",
                "5: parameters must be the formula's own, got { k = 0.0, q = 1.0 }; the parameter q does not occur in the \
                 formula; take it away",
            ),
            (
                "name",
                "\"scale\"",
                "2: name must be a name of its own, got \"scale\"; \"scale\" cannot be the name of an effect: the \
                 catalogue has an effect of this name",
            ),
        ] {
            let value_of = |k: &str, v| if k == key { value } else { v };
            let lines = good.map(|(k, v)| (k, value_of(k, v))).into_iter().filter(|(_, v)| !v.is_empty());
            let text: String = lines.map(|(k, v)| format!("{k} = {v}\n")).collect();
            let error = read(&format!("[[effect]]\n{text}")).map(|_| ()).unwrap_err().to_string();
            assert_eq!(error, format!("model.toml:{said}"));
        }
    }

    #[test]
    fn what_cannot_be_meant_is_refused_with_line_key_and_range() {
        for (lines, said) in [
            (
                "name = \"wheelbse\"",
                "2: name must be the name of an effect, got \"wheelbse\"; did you mean \"wheelbase\"?",
            ),
            ("name = \"zzz\"", "2: name must be the name of an effect, got \"zzz\""),
            ("e_b = 1.0", "1: [[effect]] has no name; add e.g. name = \"wheelbase\""),
            ("name = \"wheelbase\"\ne_d = 1.0", "3: unknown key \"e_d\" in [[effect]]; did you mean \"e_b\"?"),
            ("name = \"wheelbase\"\ne_b = 9.0", "3: e_b must be between 0.2 and 5, got 9.0"),
            ("name = \"wheelbase\"\nfree = 1", "3: free must be true or false, got 1"),
            (
                "name = \"wheelbase\"\ne_b = { mean = 1.0 }",
                "3: e_b has no sd; add mean and sd, min and max, min, mode and max, or min, max and scale = \"log\"",
            ),
            (
                "name = \"wheelbase\"\ne_b = { mean = 1.0, sd = -1 }",
                "3: sd of e_b must be finite and 0 or more, got -1",
            ),
            ("name = \"wheelbase\"\ne_b = { mean = 9.0, sd = 1 }", "3: mean of e_b must be between 0.2 and 5, got 9.0"),
            (
                "name = \"wheelbase\"\ne_b = { min = 1.1, max = 1.0 }",
                "3: max of e_b must be min (1.1) or more, got 1.0; exchange them",
            ),
            (
                "name = \"placed_bumps\"\nprofile = \"cabel\"",
                "3: profile must be one of cable, edge, got \"cabel\"; did you mean \"cable\"?",
            ),
            (
                "name = \"placed_bumps\"\nprofile = { min = 0, max = 1 }",
                "3: profile must be one of cable, edge, got { min = 0, max = 1 }; it cannot be drawn",
            ),
            (
                "name = \"scale\"\n[[effect]]\nname = \"scale\"",
                "4: name says what name in line 2 says already; keep one of them",
            ),
        ] {
            let error = read(&format!("[[effect]]\n{lines}\n")).map(|_| ()).unwrap_err().to_string();
            assert_eq!(error, format!("model.toml:{said}"));
        }
        assert_eq!(
            read("effect = 3").map(|_| ()).unwrap_err().to_string(),
            "model.toml:1: effect must be a list of tables, each headed [[effect]], got 3"
        );
    }
}
