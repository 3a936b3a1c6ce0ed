//! The user's own URDF with other wheels and another distance between them, and nothing else changed.

use super::text::{number, to_nanometre};
use super::{Export, ExportError, Target, Written};
use crate::known_numbers::KnownNumbers;
use crate::remedy::{Argument, Remedy};
use crate::wheel_names::{Side, candidates};
use crate::whole_file::in_words;
use roxmltree::{Attribute, Document, Node};
use std::ops::Range;
use std::path::Path;
use umbmark_core::drive::Wheel;

/// Where the wheels stand and how large they are; all other bytes stay as they are.
pub static TARGET: Target = Target {
    name: "urdf",
    about: "your own URDF with corrected wheel radii and wheel separation, and nothing else changed",
    holds_all: false,
    write,
};

/// A difference between the file and the nominal robot that is worth a note \[m\].
const NOTABLE: f64 = 1e-6;
const NAME_THEM: &str = "name the joints of both wheels, on one link, with";
const EXPAND: &str = "is an expression: give the file that xacro makes of it (xacro robot.urdf.xacro > robot.urdf)";

/// A description of a robot, as the user has it.
#[derive(Clone, Debug, PartialEq)]
pub struct UrdfFile {
    /// What messages call it.
    pub name: String,
    /// The file.
    pub text: String,
    /// Joints of the left and the right wheel, where their names leave that open.
    pub joints: Option<[String; 2]>,
}

fn write(export: &Export) -> Result<Written, ExportError> {
    let corrected = export.corrected()?.drive;
    let kind = corrected.kind();
    if !kind.has_axle_wheels() && (!kind.steers() || kind.drives_front_wheel()) {
        return Err(export.no_drive(TARGET.name));
    }
    let remedy = Remedy::Name { purpose: "give it with", argument: Argument::Urdf, value: "FILE" };
    let file = export.urdf.as_ref().ok_or(ExportError::NoFile { target: TARGET.name, remedy })?;
    let document = file.document()?;
    let wheels = file.wheels(&document)?;
    let mut notes = export.uncorrected();
    let mut edits = Vec::new();
    let nominal = &export.robot().drive;
    let separation = wheels[0].contact()? - wheels[1].contact()?;
    if (separation.abs() - nominal.wheelbase()).abs() > NOTABLE {
        notes.push(changed("wheel separation", separation.abs(), nominal.wheelbase(), corrected.wheelbase()));
    }
    let apart = 0.5 * (corrected.wheelbase() - separation.abs()) * separation.signum();
    for (wheel, move_by) in wheels.iter().zip([apart, -apart]) {
        edits.push(wheel.moved(move_by)?);
    }
    let radii = [
        (nominal.wheel_diameter_left(), corrected.wheel_diameter_left()),
        (nominal.wheel_diameter_right(), corrected.wheel_diameter_right()),
    ];
    for (wheel, (before, after)) in wheels.iter().zip(radii) {
        let found = wheel.radii()?;
        let Some((radius, _)) = found.first() else {
            let radius = number(to_nanometre(0.5 * after));
            notes.push(format!(
                "not in this file: the radius of the {} wheel, {radius} m, because its link has no cylinder or sphere; scale its mesh",
                wheel.side
            ));
            continue;
        };
        if (radius - 0.5 * before).abs() > NOTABLE {
            notes.push(changed(&format!("radius of the {} wheel", wheel.side), *radius, 0.5 * before, 0.5 * after));
        }
        edits.extend(found.iter().map(|(_, place)| (place.clone(), number(to_nanometre(0.5 * after)))));
    }
    edits.sort_by_key(|(place, _)| std::cmp::Reverse(place.start));
    let mut text = file.text.clone();
    for (place, value) in edits {
        text.replace_range(place, &value);
    }
    Ok(Written { text, notes })
}

fn changed(what: &str, file: f64, nominal: f64, corrected: f64) -> String {
    let [file, nominal, corrected] = [file, nominal, corrected].map(|length| number(to_nanometre(length)));
    format!(
        "the file had a {what} of {file} m, the nominal robot of the model has {nominal} m; now it is {corrected} m"
    )
}

impl UrdfFile {
    /// Reads a file to the byte.
    pub fn read(file: impl AsRef<Path>, joints: Option<[String; 2]>) -> Result<UrdfFile, ExportError> {
        let file = file.as_ref();
        let name = file.display().to_string();
        let unreadable = |reason: String| ExportError::Unreadable { file: name.clone(), reason };
        let bytes = std::fs::read(file).map_err(|error| unreadable(in_words(&error, "there is no such file")))?;
        let text = String::from_utf8(bytes).map_err(|_| unreadable("it is not UTF-8 text".to_owned()))?;
        Ok(UrdfFile { name, text, joints })
    }

    /// Wheelbase and wheel diameters of the robot that it describes.
    ///
    /// The wheelbase is the distance of the two wheels along y of their parent link, at their collision shapes; a diameter is twice
    /// the radius of the collision shape, else of the largest cylinder or sphere that is seen. A wheel that is a mesh has none.
    ///
    /// # Errors
    ///
    /// Where it is not XML, and where its joints do not say which are the wheels.
    pub fn numbers(&self) -> Result<KnownNumbers, ExportError> {
        let document = self.document()?;
        let wheels = self.wheels(&document)?;
        let mut known = KnownNumbers::of(&self.name);
        known.name = document.root_element().attribute("name").map(str::to_owned);
        let separation = (wheels[0].contact()? - wheels[1].contact()?).abs();
        known.push("wheelbase_m", to_nanometre(separation), "the joints of the wheels");
        for (wheel, key) in wheels.iter().zip(["wheel_diameter_left_m", "wheel_diameter_right_m"]) {
            if let Some((radius, _)) = wheel.radii()?.first() {
                known.push(key, to_nanometre(2.0 * radius), "the shape of the wheel");
            }
        }
        Ok(known)
    }

    fn document(&self) -> Result<Document<'_>, ExportError> {
        Document::parse(&self.text)
            .map_err(|error| self.wrong(error.pos().row, format!("is not XML: {error}; give a URDF file")))
    }

    fn wrong(&self, line: u32, problem: String) -> ExportError {
        ExportError::File { file: self.name.clone(), line, problem, remedy: None }
    }

    /// A problem that goes where the user names the joints.
    fn unclear(&self, line: u32, problem: String) -> ExportError {
        let remedy = Remedy::Name { purpose: NAME_THEM, argument: Argument::Joints, value: "LEFT,RIGHT" };
        ExportError::File { file: self.name.clone(), line, problem, remedy: Some(remedy) }
    }

    fn wheels<'a>(&'a self, document: &'a Document) -> Result<[WheelJoint<'a>; 2], ExportError> {
        let robot = document.root_element();
        let joints: Vec<Node> = robot.children().filter(|node| node.has_tag_name("joint")).collect();
        let turning = |node: &Node| node.attribute("type") == Some("continuous");
        let [left, right] = match &self.joints {
            Some(chosen) => chosen.each_ref().map(String::as_str),
            None => {
                let names = || joints.iter().filter(|node| turning(node)).filter_map(|node| node.attribute("name"));
                let sides = [Side::Left, Side::Right].map(|side| candidates(names(), side));
                let ([left], [right]) = (&sides[0][..], &sides[1][..]) else {
                    let all: Vec<&str> = names().collect();
                    let all = if all.is_empty() { "none".to_owned() } else { all.join(", ") };
                    let problem = format!("the joints of the left and the right wheel are not clear among {all}");
                    return Err(self.unclear(1, problem));
                };
                [*left, *right]
            }
        };
        let find = |side: Wheel, name: &str| {
            let joint = joints.iter().find(|node| node.attribute("name") == Some(name)).copied();
            let joint = joint.ok_or_else(|| {
                let all: Vec<&str> = joints.iter().filter_map(|node| node.attribute("name")).collect();
                self.wrong(1, format!("there is no joint \"{name}\"; its joints are {}", all.join(", ")))
            })?;
            WheelJoint::of(self, side, joint)
        };
        let wheels = [find(Wheel::Left, left)?, find(Wheel::Right, right)?];
        let [parent, other] = wheels.each_ref().map(|wheel| linked(wheel.joint, "parent"));
        if parent != other {
            let line = wheels[1].line();
            let problem = format!(
                "\"{left}\" and \"{right}\" have different parent links, so they do not say how far apart they are"
            );
            return Err(self.unclear(line, problem));
        }
        Ok(wheels)
    }
}

/// The link that a joint names as its parent or child.
fn linked<'a>(joint: Node<'a, '_>, end: &str) -> Option<&'a str> {
    joint.children().find(|node| node.has_tag_name(end)).and_then(|node| node.attribute("link"))
}

/// The joint of a wheel.
struct WheelJoint<'a> {
    file: &'a UrdfFile,
    side: Wheel,
    joint: Node<'a, 'a>,
    link: Node<'a, 'a>,
}

impl<'a> WheelJoint<'a> {
    fn of(file: &'a UrdfFile, side: Wheel, joint: Node<'a, 'a>) -> Result<WheelJoint<'a>, ExportError> {
        let child = linked(joint, "child");
        let mut links = joint.parent().into_iter().flat_map(|robot| robot.children());
        let link = links.find(|node| node.has_tag_name("link") && child.is_some() && node.attribute("name") == child);
        let line = joint.document().text_pos_at(joint.range().start).row;
        let problem =
            || format!("the joint of the {side} wheel has no <child link=\"...\"/> that is a link of the file");
        Ok(WheelJoint { file, side, joint, link: link.ok_or_else(|| file.wrong(line, problem()))? })
    }

    fn line(&self) -> u32 {
        self.joint.document().text_pos_at(self.joint.range().start).row
    }

    /// The numbers of an attribute, with where they stand.
    fn numbers(&self, attribute: &Attribute) -> Result<Vec<(f64, Range<usize>)>, ExportError> {
        let place = attribute.range_value();
        let line = self.joint.document().text_pos_at(place.start).row;
        let raw = &self.file.text[place.clone()];
        let number = |word: &str| {
            let value = word.parse().ok().filter(|value: &f64| value.is_finite());
            let start = place.start + (word.as_ptr() as usize - raw.as_ptr() as usize);
            let allowed = if word.contains("${") { EXPAND } else { "must be a finite number" };
            let problem = format!("{} {allowed}, got \"{word}\"", attribute.name());
            Ok((value.ok_or_else(|| self.file.wrong(line, problem))?, start..start + word.len()))
        };
        raw.split_ascii_whitespace().map(number).collect()
    }

    /// Three numbers of an attribute of an origin; 0 where it is not there.
    fn three(&self, owner: Node, name: &str) -> Result<[f64; 3], ExportError> {
        let origin = owner.children().find(|node| node.has_tag_name("origin"));
        let Some(attribute) = origin.as_ref().and_then(|origin| origin.attribute_node(name)) else {
            return Ok([0.0; 3]);
        };
        let numbers = self.numbers(&attribute)?;
        match numbers[..] {
            [(x, _), (y, _), (z, _)] => Ok([x, y, z]),
            _ => {
                let line = self.joint.document().text_pos_at(attribute.range().start).row;
                Err(self.file.wrong(line, format!("{name} must be three numbers, got {}", numbers.len())))
            }
        }
    }

    /// y of the wheel in the frame of its parent link: that of the joint, and of the collision shape on it.
    fn contact(&self) -> Result<f64, ExportError> {
        let [_, y, _] = self.three(self.joint, "xyz")?;
        let [roll, pitch, yaw] = self.three(self.joint, "rpy")?;
        let shape = self.link.children().find(|node| node.has_tag_name("collision"));
        let [ahead, aside, above] = shape.map_or(Ok([0.0; 3]), |shape| self.three(shape, "xyz"))?;
        let ([sr, cr], [sp, cp], [sy, cy]) = (sin_cos(roll), sin_cos(pitch), sin_cos(yaw));
        Ok(y + sy * cp * ahead + (sy * sp * sr + cy * cr) * aside + (sy * sp * cr - cy * sr) * above)
    }

    /// The edit that moves it along y.
    fn moved(&self, by: f64) -> Result<(Range<usize>, String), ExportError> {
        let origin = self.joint.children().find(|node| node.has_tag_name("origin"));
        let attribute = origin.as_ref().and_then(|origin| origin.attribute_node("xyz"));
        let problem = || {
            self.file.wrong(
                self.line(),
                format!("the joint of the {} wheel has no <origin xyz=\"x y z\"/>; add one", self.side),
            )
        };
        let numbers = self.numbers(&attribute.ok_or_else(problem)?)?;
        let (y, place) = numbers.get(1).cloned().ok_or_else(problem)?;
        Ok((place, number(to_nanometre(y + by))))
    }

    /// The wheel's radius wherever it stands in its link: that of its collision shape, else the largest that is seen.
    fn radii(&self) -> Result<Vec<(f64, Range<usize>)>, ExportError> {
        let of = |what: &str| {
            let shapes =
                self.link.children().filter(|node| node.has_tag_name(what)).flat_map(|node| node.descendants());
            let round = shapes.filter(|node| node.has_tag_name("cylinder") || node.has_tag_name("sphere"));
            let mut found = Vec::new();
            for attribute in round.filter_map(|node| node.attribute_node("radius")) {
                found.extend(self.numbers(&attribute)?);
            }
            Ok::<_, ExportError>(found)
        };
        let (touching, seen) = (of("collision")?, of("visual")?);
        let largest = |of: &[(f64, Range<usize>)]| of.iter().map(|(radius, _)| *radius).fold(0.0, f64::max);
        let radius = if touching.is_empty() { largest(&seen) } else { largest(&touching) };
        Ok(touching.into_iter().chain(seen).filter(|(other, _)| (other - radius).abs() < NOTABLE).collect())
    }
}

fn sin_cos(angle: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [sin, cos]
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbmark_core::drive::Robot;
    use umbmark_core::effect::Model;

    const URDF: &str = "<?xml version=\"1.0\"?>\r\n<!-- mine -->\n<robot name='bot'>\n  <link name=\"base\"/>\n\
        \t<link name=\"wl\"><collision><origin xyz=\"0 0 0.01\" rpy=\"0 0 0\"/><geometry><cylinder length='0.02' radius='0.0750'/></geometry></collision>\
        <visual><geometry><cylinder radius=\"0.075\" length=\"0.02\"/></geometry></visual>\
        <visual><geometry><cylinder radius=\"0.02\" length=\"0.03\"/></geometry></visual></link>\n\
          <link name=\"wr\"><collision><origin xyz=\"0 0 -0.01\"/><geometry><sphere radius=\"0.075\"/></geometry></collision></link>\n\
          <joint name=\"wheel_left_joint\" type=\"continuous\"><parent link=\"base\"/><child link=\"wl\"/><origin xyz=\"0.0   0.16 0.023\" rpy=\"-1.57079632679 0 0\"/></joint>\n\
          <joint name=\"wheel_right_joint\" type=\"continuous\"><parent link=\"base\"/><child link=\"wr\"/><origin rpy=\"-1.57079632679 0 0\" xyz=\"0 -.16 0.023\"/></joint>\n\
          <joint name=\"left_arm\" type=\"continuous\"/>\n</robot>\n";

    fn model() -> Model {
        let mut model = Model::new(&Robot::labmate());
        model.set("wheel_diameter_ratio", "e_d", 1.002).unwrap();
        model.set("wheelbase", "e_b", 1.01).unwrap();
        model
    }

    fn write_of(text: &str, joints: Option<[&str; 2]>) -> Result<Written, ExportError> {
        let joints = joints.map(|joints| joints.map(str::to_owned));
        let urdf = Some(UrdfFile { name: "bot.urdf".into(), text: text.into(), joints });
        TARGET.write(&Export { urdf, ..Export::of(&model()) })
    }

    /// Oracle: the same text with the numbers put in by hand; the collision shapes stand 1 cm outside of the joints.
    #[test]
    fn the_numbers_change_and_every_other_byte_stays() {
        let Written { text, notes } = write_of(URDF, None).unwrap();
        let by_hand = URDF
            .replace("0.0   0.16 0.023", "0.0   0.1617 0.023")
            .replace("0 -.16 0.023", "0 -0.1617 0.023")
            .replace("'0.0750'", "'0.074925075'")
            .replace("<cylinder radius=\"0.075\"", "<cylinder radius=\"0.074925075\"")
            .replace("<sphere radius=\"0.075\"", "<sphere radius=\"0.075074925\"");
        assert_eq!(text, by_hand);
        assert!(notes.is_empty(), "{notes:?}");
        assert_eq!(write_of(&text, None).unwrap().text, text, "a second time changes nothing");
    }

    #[test]
    fn a_file_of_another_robot_and_a_wheel_of_a_mesh_are_said() {
        let other =
            URDF.replace("0.16 0.023", "0.2 0.023").replace("<sphere radius=\"0.075\"/>", "<mesh filename=\"w.stl\"/>");
        let notes = write_of(&other, None).unwrap().notes;
        assert!(notes[0].starts_with("the file had a wheel separation of 0.38 m"), "{notes:?}");
        assert!(notes[1].starts_with("not in this file: the radius of the right wheel, 0.075074925 m"), "{notes:?}");
    }

    #[test]
    fn what_cannot_be_edited_is_refused_with_its_line_and_what_to_do() {
        let said = |text: &str, joints| write_of(text, joints).unwrap_err().to_string();
        assert!(said("<robot>", None).starts_with("bot.urdf:1: is not XML: "));
        let both = URDF.replace("left_arm", "left_wheel_2");
        assert!(said(&both, None).ends_with("name the joints of both wheels, on one link, with joints LEFT,RIGHT"));
        assert!(
            said(URDF, Some(["a", "b"]))
                .contains("there is no joint \"a\"; its joints are wheel_left_joint, wheel_right_joint, left_arm")
        );
        let xacro = URDF.replace("0.16 0.023\" rpy", "${w/2} 0.023\" rpy");
        assert!(said(&xacro, None).starts_with("bot.urdf:7: xyz is an expression: "), "{}", said(&xacro, None));
        let nan = URDF.replace("'0.0750'", "'NaN'");
        assert_eq!(said(&nan, None), "bot.urdf:5: radius must be a finite number, got \"NaN\"");
        let apart = URDF.replacen(
            "<parent link=\"base\"/><child link=\"wr\"/>",
            "<parent link=\"wl\"/><child link=\"wr\"/>",
            1,
        );
        assert!(said(&apart, None).contains("have different parent links"));
        let bare = URDF.replace(" xyz=\"0 -.16 0.023\"", "");
        assert!(said(&bare, None).contains("the joint of the right wheel has no <origin xyz"), "{}", said(&bare, None));
        let nothing = TARGET.write(&Export::of(&model())).unwrap_err();
        assert_eq!(nothing.to_string(), "urdf: the file to edit is missing; give it with urdf FILE");
    }
}
