//! The table of rooms in CONTRIBUTING.md, from the ground up, held against the code: no room names one above it.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};

/// A crate's folder whose rooms the table lists.
const CORE: &str = "crates/umbmark-core/src";

fn top() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The rooms in the order of the table: `a`, `b` in one row stand in this order too.
fn rooms() -> Vec<String> {
    let page = std::fs::read_to_string(top().join("CONTRIBUTING.md")).expect("the page is there");
    let table = page.split_once("| room of `umbmark-core` | holds |").expect("CONTRIBUTING.md has the table").1;
    let rows = table.lines().skip(2).take_while(|line| line.starts_with('|'));
    let names = |row: &str| {
        row.split('|')
            .nth(1)
            .expect("a row has cells")
            .split(',')
            .map(|n| n.trim_matches([' ', '`']).to_owned())
            .collect()
    };
    rows.flat_map(|row| -> Vec<String> { names(row) }).collect()
}

/// What a file names after `crate::`, outside tests, and the modules of tests that it declares.
#[derive(Default)]
struct Named {
    rooms: BTreeSet<String>,
    tests: Vec<String>,
}

fn is_test(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|a| a.path().is_ident("cfg") && a.parse_args::<syn::Ident>().is_ok_and(|cfg| cfg == "test"))
}

impl Visit<'_> for Named {
    fn visit_item_mod(&mut self, module: &syn::ItemMod) {
        match is_test(&module.attrs) {
            true => self.tests.push(module.ident.to_string()),
            false => visit::visit_item_mod(self, module),
        }
    }

    fn visit_item_fn(&mut self, function: &syn::ItemFn) {
        if !is_test(&function.attrs) {
            visit::visit_item_fn(self, function);
        }
    }

    fn visit_item_use(&mut self, item: &syn::ItemUse) {
        if !is_test(&item.attrs) {
            visit::visit_item_use(self, item);
        }
    }

    fn visit_use_path(&mut self, path: &syn::UsePath) {
        if path.ident == "crate" {
            self.begins(&path.tree);
        }
    }

    fn visit_path(&mut self, path: &syn::Path) {
        if path.segments.len() > 1 && path.segments[0].ident == "crate" {
            self.rooms.insert(path.segments[1].ident.to_string());
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, called: &syn::Macro) {
        // Tokens within a call: `crate :: room`.
        let text = called.tokens.to_string();
        let named = text
            .split("crate :: ")
            .skip(1)
            .filter_map(|rest| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next());
        self.rooms.extend(named.map(str::to_owned));
        visit::visit_macro(self, called);
    }
}

impl Named {
    fn begins(&mut self, tree: &syn::UseTree) {
        match tree {
            syn::UseTree::Path(path) => drop(self.rooms.insert(path.ident.to_string())),
            syn::UseTree::Name(name) => drop(self.rooms.insert(name.ident.to_string())),
            syn::UseTree::Rename(name) => drop(self.rooms.insert(name.ident.to_string())),
            syn::UseTree::Group(group) => group.items.iter().for_each(|tree| self.begins(tree)),
            syn::UseTree::Glob(_) => {}
        }
    }
}

/// What the file of a module and those in its folder name, each with the file.
fn named_by(module: &Path, found: &mut Vec<(String, PathBuf)>) {
    let (file, mut named) = (module.with_extension("rs"), Named::default());
    let text = std::fs::read_to_string(&file).unwrap_or_else(|why| panic!("{}: {why}", file.display()));
    named.visit_file(&syn::parse_file(&text).expect("it compiles"));
    found.extend(named.rooms.into_iter().map(|room| (room, file.clone())));
    let below = std::fs::read_dir(module).into_iter().flatten().flatten().map(|entry| entry.path());
    let modules = below.filter(|path| path.extension().is_some_and(|ending| ending == "rs"));
    for module in modules.map(|path| path.with_extension("")) {
        if !named.tests.iter().any(|test| module.ends_with(test)) {
            named_by(&module, found);
        }
    }
}

/// The crates in the order of their table.
fn crates() -> Vec<String> {
    let page = std::fs::read_to_string(top().join("CONTRIBUTING.md")).expect("the page is there");
    let table = page.split_once("| crate | holds |").expect("CONTRIBUTING.md has the table").1;
    let rows = table.lines().skip(2).take_while(|line| line.starts_with('|'));
    rows.map(|row| row.split('`').nth(1).expect("a row names a crate").to_owned()).collect()
}

#[test]
fn every_crate_is_in_the_table_and_depends_only_on_those_before_it() {
    let crates = crates();
    let folders = std::fs::read_dir(top().join("crates")).unwrap();
    let there: BTreeSet<String> =
        folders.map(|entry| entry.unwrap().file_name().into_string().expect("a name is text")).collect();
    assert_eq!(
        crates.iter().cloned().collect::<BTreeSet<_>>(),
        there,
        "the table of CONTRIBUTING.md and the folder crates"
    );
    for (floor, name) in crates.iter().enumerate() {
        let manifest = std::fs::read_to_string(top().join("crates").join(name).join("Cargo.toml")).unwrap();
        let (_, depends) = manifest.split_once("\n[dependencies]\n").expect("a crate depends on something");
        let depends = depends.split("\n[").next().expect("a text has a first part");
        for other in
            depends.lines().filter_map(|line| line.split('.').next().filter(|name| name.starts_with("umbmark")))
        {
            assert!(crates[..floor].iter().any(|below| below == other), "{name} depends on {other}");
        }
    }
}

#[test]
fn odometry_on_the_robot_has_no_unsafe_code_no_allocation_and_one_dependency() {
    let home = top().join("crates/umbmark-odometry");
    let library = std::fs::read_to_string(home.join("src/lib.rs")).unwrap();
    assert!(library.contains("\n#![no_std]\n#![forbid(unsafe_code)]\n"));
    let outside_tests = library.replace("#[cfg(test)]\nextern crate std;\n", "");
    assert!(!outside_tests.contains("extern crate"), "neither std nor alloc");
    let manifest = std::fs::read_to_string(home.join("Cargo.toml")).unwrap();
    assert!(manifest.contains("\n[dependencies]\nlibm.workspace = true\n\n["));
}

#[test]
fn every_room_is_in_the_table_and_names_only_those_before_it() {
    let (core, rooms) = (top().join(CORE), rooms());
    let files = std::fs::read_dir(&core).unwrap().map(|entry| entry.unwrap().path());
    let there: BTreeSet<String> = files
        .filter(|path| path.extension().is_some_and(|e| e == "rs") && !path.ends_with("lib.rs"))
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
        .collect();
    assert_eq!(
        rooms.iter().cloned().collect::<BTreeSet<_>>(),
        there,
        "the table of CONTRIBUTING.md and the files of {CORE}"
    );
    let mut against = Vec::new();
    for (floor, room) in rooms.iter().enumerate() {
        let mut named = Vec::new();
        named_by(&core.join(room), &mut named);
        let above = named.into_iter().filter(|(other, _)| rooms[floor + 1..].contains(other));
        against.extend(above.map(|(other, file)| format!("{room} names {other} in {}", file.display())));
    }
    assert!(against.is_empty(), "rooms that name one above them:\n{}", against.join("\n"));
}
