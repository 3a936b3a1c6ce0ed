//! Parameters that vary: their distributions, what tighter ones cost, and how they go together.

use super::distribution_table::{DISTRIBUTIONS, read_distribution};
use super::document::{Entry, Source, Table};
use super::error::DatasetError;
use super::source::read_text;
use umbmark_core::monte_carlo::{Quantity, Study};
use umbmark_core::sensitivity::tolerance::{Grade, Varied};

/// What a file of varied parameters holds.
#[derive(Clone, Debug)]
pub struct ParameterFile {
    /// The parameters with their grades, in the order of the file; one without grades there has that one at no cost.
    pub parameters: Vec<Varied>,
    /// Correlations of two of them, by their places.
    pub correlations: Vec<([usize; 2], f64)>,
}

/// The varied parameters of a file; names are looked up in `study`.
pub fn read_parameters(file: impl AsRef<std::path::Path>, study: &Study) -> Result<ParameterFile, DatasetError> {
    let file = file.as_ref();
    parse_parameters(&file.display().to_string(), &read_text(file)?, study)
}

/// The same from text; `file` is what messages call it.
///
/// ```
/// use umbmark_io::parse_parameters;
/// use umbmark_core::{drive::Robot, effect::Model, monte_carlo::Study};
/// let study = Study::new(Model::new(&Robot::labmate()), 100, 1);
/// let text = "[[parameter]]\nname = \"ed\"\nmean = 1.0\nsd = 0.001\n\n[[parameter]]\nname = \"eb\"\n\
///             grades = [{ mean = 1.0, sd = 0.01, cost = 0 }, { mean = 1.0, sd = 0.005, cost = 12 }]\n\n\
///             [[correlation]]\nof = [\"ed\", \"eb\"]\nvalue = 0.3\n";
/// let file = parse_parameters("robots.toml", text, &study)?;
/// assert_eq!((file.parameters[1].grades[1].cost, file.correlations[0]), (12.0, ([0, 1], 0.3)));
/// # Ok::<(), umbmark_io::DatasetError>(())
/// ```
pub fn parse_parameters(file: &str, text: &str, study: &Study) -> Result<ParameterFile, DatasetError> {
    let source = Source { file, text };
    let root = source.parse()?;
    let root = Table::root(&source, &root);
    root.only(&["parameter", "correlation"])?;
    let list = root.need("parameter", "a list of tables, each headed [[parameter]]")?;
    let (mut parameters, mut names) = (Vec::new(), Vec::<Entry>::new());
    for entry in list.list("a list of tables, each headed [[parameter]]")? {
        let table = entry.table("[[parameter]]".into())?;
        let (name, quantity) = quantity(table.need("name", "e.g. name = \"ed\"")?, study)?;
        if let Some(first) = parameters.iter().position(|known: &Varied| known.quantity.key() == quantity.key()) {
            return Err(names[first].again(&name));
        }
        names.push(name);
        parameters.push(Varied { quantity, grades: grades(&table, &quantity)? });
    }
    let place = |entry: &Entry| -> Result<usize, DatasetError> {
        let (name, quantity) = quantity(*entry, study)?;
        let place = parameters.iter().position(|known| known.quantity.key() == quantity.key());
        place.ok_or_else(|| name.wrong("a parameter of this file", ""))
    };
    let mut correlations = Vec::new();
    let entries = root.get("correlation").map_or(Ok(Vec::new()), |e| e.list("a list of tables, [[correlation]]"))?;
    for entry in entries {
        let table = entry.table("[[correlation]]".into())?;
        table.only(&["of", "value"])?;
        let of = table.need("of", "e.g. of = [\"ed\", \"eb\"]")?;
        let pair = of.list("two names of parameters")?;
        let [one, two] = pair.as_slice() else { return Err(of.wrong("two names of parameters", "")) };
        let value = table.need("value", "e.g. value = 0.3")?;
        let number = value.any_number().filter(|value| value.abs() < 1.0);
        let number = number.ok_or_else(|| value.wrong("between -1 and 1, both excluded", ""))?;
        correlations.push(([place(one)?, place(two)?], number));
    }
    Ok(ParameterFile { parameters, correlations })
}

fn quantity<'a>(name: Entry<'a>, study: &Study) -> Result<(Entry<'a>, Quantity), DatasetError> {
    let word = name.word("the name of a parameter")?;
    let found = Quantity::find(word, study);
    found.map(|found| (name, found)).map_err(|error| name.wrong("a parameter that can be varied", &error.to_string()))
}

fn grades(table: &Table, quantity: &Quantity) -> Result<Vec<Grade>, DatasetError> {
    let parameter = quantity.parameter();
    let Some(entry) = table.get("grades") else {
        let distribution = read_distribution(table, parameter, &["name"])?;
        return Ok(vec![Grade { distribution, cost: 0.0 }]);
    };
    table.only(&["name", "grades"])?;
    let allowed = format!("a list of grades, each with a cost and {DISTRIBUTIONS}");
    let grade = |entry: Entry| -> Result<Grade, DatasetError> {
        let table = entry.table("a grade".into())?;
        let cost = table.need("cost", "e.g. cost = 0")?;
        let number = cost.any_number().filter(|cost| *cost >= 0.0 && cost.is_finite());
        let cost = number.ok_or_else(|| cost.wrong("finite and 0 or more", ""))?;
        Ok(Grade { distribution: read_distribution(&table, parameter, &["cost"])?, cost })
    };
    let grades: Vec<Grade> = entry.list(&allowed)?.into_iter().map(grade).collect::<Result<_, _>>()?;
    if grades.is_empty() { Err(entry.wrong(&allowed, "")) } else { Ok(grades) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbmark_core::drive::Robot;
    use umbmark_core::effect::Model;
    use umbmark_core::monte_carlo::Distribution;

    fn read(text: &str) -> Result<ParameterFile, DatasetError> {
        parse_parameters("robots.toml", text, &Study::new(Model::new(&Robot::labmate()), 1, 1))
    }

    #[test]
    fn every_form_of_distribution_is_read() {
        let named = |name: &str, form: &str| format!("[[parameter]]\nname = \"{name}\"\n{form}\n");
        let text = named("ed", "mean = 1.0\nsd = 0.001")
            + &named("wheelbase.e_b", "min = 0.99\nmax = 1.01")
            + &named("es", "min = 0.99\nmode = 1.0\nmax = 1.02")
            + &named("ticks-per-revolution", "min = 100\nmax = 10000\nscale = \"log\"");
        let found: Vec<Distribution> =
            read(&text).unwrap().parameters.iter().map(|varied| varied.grades[0].distribution).collect();
        let expected = [
            Distribution::Normal { mean: 1.0, sd: 0.001 },
            Distribution::Uniform { min: 0.99, max: 1.01 },
            Distribution::Triangular { min: 0.99, mode: 1.0, max: 1.02 },
            Distribution::LogUniform { min: 100.0, max: 10_000.0 },
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn what_cannot_be_meant_is_refused_with_line_key_and_range() {
        let ed = "[[parameter]]\nname = \"ed\"\nmean = 1.0\nsd = 0.1\n";
        for (text, said) in [
            ("".to_owned(), "1: the file has no parameter; add a list of tables, each headed [[parameter]]"),
            (
                "[[parameter]]\nname = \"edd\"\n".to_owned(),
                "2: name must be a parameter that can be varied, got \"edd\"; there is no parameter \"edd\"; did you mean \"ed\"?",
            ),
            (ed.to_owned() + ed, "6: name says what name in line 2 says already; keep one of them"),
            (ed.replace("1.0", "3.0"), "3: mean of e_d must be between 0.5 and 2, got 3.0"),
            (ed.replace("sd = 0.1", "sdd = 0.1"), "4: unknown key \"sdd\" in [[parameter]]; did you mean \"sd\"?"),
            (
                "[[parameter]]\nname = \"eb\"\nmin = 1\nmax = 1.2\nmode = 1.3\n".to_owned(),
                "5: mode of e_b must be between min (1) and max (1.2), got 1.3",
            ),
            (
                "[[parameter]]\nname = \"eb\"\ngrades = [{ mean = 1.0, sd = 0.1 }]\n".to_owned(),
                "3: a grade has no cost; add e.g. cost = 0",
            ),
            (
                format!("{ed}[[correlation]]\nof = [\"ed\", \"eb\"]\nvalue = 0.5\n"),
                "6: of must be a parameter of this file, got \"eb\"",
            ),
            (
                format!("{ed}[[correlation]]\nof = [\"ed\", \"ed\"]\nvalue = 1\n"),
                "7: value must be between -1 and 1, both excluded, got 1",
            ),
        ] {
            let error = read(&text).map(|_| ()).unwrap_err().to_string();
            assert_eq!(error, format!("robots.toml:{said}"), "{text}");
        }
    }
}
