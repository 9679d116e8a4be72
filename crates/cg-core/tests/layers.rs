//! Dependencies point one way: between crates, between modules, and between files.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use syn::visit::{self, Visit};

/// The libraries in the order of ARCHITECTURE.md. A crate uses only those before it.
const CRATES: [&str; 7] =
    ["cg-core", "cg-vehicle", "cg-output", "cg-logs", "cg-plant", "cg-fmu", "cg-thesis"];
/// The crates that connect the libraries to their users.
const DOORS: [&str; 4] = ["cg-cli", "cg-ffi", "cg-fmi", "cg-py"];

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().join(name)
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn parsed(path: &Path) -> syn::File {
    syn::parse_file(&read(path)).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The path of a module: `["decide", "height"]`; empty for the crate's root.
type Module = Vec<String>;

/// The modules of a crate that have their own file, in the order of their declaration.
struct Modules {
    files: BTreeMap<Module, PathBuf>,
    order: Vec<Module>,
}

impl Modules {
    fn of(name: &str) -> Self {
        let src = folder(name).join("src");
        let root = ["lib.rs", "main.rs"].map(|file| src.join(file));
        let root = root.into_iter().find(|path| path.exists()).unwrap();
        let mut modules = Self { files: BTreeMap::new(), order: Vec::new() };
        modules.add(Module::new(), root, &src);
        modules
    }

    fn add(&mut self, module: Module, file: PathBuf, children: &Path) {
        for item in parsed(&file).items {
            let syn::Item::Mod(child) = item else { continue };
            let name = child.ident.to_string();
            if child.content.is_some() || is_test(&child.attrs) {
                continue;
            }
            let mut path = module.clone();
            path.push(name.clone());
            let one = children.join(format!("{name}.rs"));
            let folder = children.join(&name);
            let at = if one.exists() { one } else { folder.join("mod.rs") };
            self.add(path, at, &folder);
        }
        self.order.push(module.clone());
        self.files.insert(module, file);
    }

    /// The last module on a path that has its own file.
    fn deepest(&self, start: Module, rest: &[String]) -> Module {
        let mut at = start;
        for name in rest {
            let mut below = at.clone();
            below.push(name.clone());
            if !self.files.contains_key(&below) {
                break;
            }
            at = below;
        }
        at
    }

    /// The modules that each module uses.
    fn arrows(&self) -> BTreeMap<Module, BTreeSet<Module>> {
        let mut arrows = BTreeMap::new();
        for (module, file) in &self.files {
            let mut seen = Seen { modules: self, module, inline: 0, used: BTreeSet::new() };
            seen.visit_file(&parsed(file));
            seen.used.remove(module);
            arrows.insert(module.clone(), seen.used);
        }
        arrows
    }
}

fn is_test(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let list = attribute.meta.require_list();
        attribute.path().is_ident("cfg") && list.is_ok_and(|list| list.tokens.to_string() == "test")
    })
}

/// Collects the modules that a file uses, in `use` and elsewhere, except in tests.
struct Seen<'a> {
    modules: &'a Modules,
    module: &'a Module,
    /// Nesting depth of inline modules in the file.
    inline: usize,
    used: BTreeSet<Module>,
}

impl Seen<'_> {
    fn names(&mut self, path: &[String]) {
        let mut rest = path;
        let mut at = self.module.clone();
        let mut inline = self.inline;
        match path.first().map(String::as_str) {
            Some("crate") => (at, rest) = (Module::new(), &path[1..]),
            Some("self") => rest = &path[1..],
            Some("super") => {}
            // `use child::Name` in the file that declares `child`.
            Some(child) => {
                let mut below = at.clone();
                below.push(child.to_owned());
                if inline > 0 || !self.modules.files.contains_key(&below) {
                    return;
                }
            }
            None => return,
        }
        while rest.first().is_some_and(|name| name == "super") {
            rest = &rest[1..];
            if inline > 0 {
                inline -= 1;
            } else {
                at.pop();
            }
        }
        let found = self.modules.deepest(at, rest);
        self.used.insert(found);
    }

    fn tree(&mut self, before: &[String], tree: &syn::UseTree) {
        let with = |name: String| [before, &[name]].concat();
        match tree {
            syn::UseTree::Path(path) => self.tree(&with(path.ident.to_string()), &path.tree),
            syn::UseTree::Name(name) => self.names(&with(name.ident.to_string())),
            syn::UseTree::Rename(rename) => self.names(&with(rename.ident.to_string())),
            syn::UseTree::Glob(_) => self.names(before),
            syn::UseTree::Group(group) => {
                group.items.iter().for_each(|tree| self.tree(before, tree));
            }
        }
    }
}

impl<'ast> Visit<'ast> for Seen<'_> {
    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        if is_test(&item.attrs) || item.content.is_none() {
            return;
        }
        self.inline += 1;
        visit::visit_item_mod(self, item);
        self.inline -= 1;
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        if !is_test(&item.attrs) {
            self.tree(&[], &item.tree);
        }
    }

    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        if !is_test(&item.attrs) {
            visit::visit_item_fn(self, item);
        }
    }

    // The paths in `pub(crate)` and `pub(in path)` are not uses of a module.
    fn visit_visibility(&mut self, _: &'ast syn::Visibility) {}

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let names: Vec<String> = path.segments.iter().map(|s| s.ident.to_string()).collect();
        if names.len() > 1 {
            self.names(&names);
        }
        visit::visit_path(self, path);
    }
}

/// A path of dependencies that ends where it starts.
fn circle(arrows: &BTreeMap<Module, BTreeSet<Module>>) -> Option<Vec<Module>> {
    fn follow(
        at: &Module,
        arrows: &BTreeMap<Module, BTreeSet<Module>>,
        way: &mut Vec<Module>,
        done: &mut BTreeSet<Module>,
    ) -> Option<Vec<Module>> {
        if let Some(start) = way.iter().position(|module| module == at) {
            return Some(way[start..].to_vec());
        }
        if !done.insert(at.clone()) {
            return None;
        }
        way.push(at.clone());
        let found = arrows[at].iter().find_map(|next| follow(next, arrows, way, done));
        way.pop();
        found
    }
    let mut done = BTreeSet::new();
    arrows.keys().find_map(|module| follow(module, arrows, &mut Vec::new(), &mut done))
}

#[test]
fn a_crate_uses_those_before_it() {
    let mut arrows = 0;
    for (place, name) in CRATES.iter().enumerate() {
        let manifest = read(&folder(name).join("Cargo.toml"));
        let dependencies = manifest.split("[dependencies]").nth(1).unwrap();
        let dependencies = dependencies.split("\n[").next().unwrap();
        for used in dependencies.lines().filter(|line| line.starts_with("cg-")) {
            let used = used.split(['.', ' ']).next().unwrap();
            let before = CRATES.iter().position(|other| *other == used);
            assert!(before.is_some_and(|before| before < place), "{name} uses {used}");
            arrows += 1;
        }
    }
    assert!(arrows >= 8, "only {arrows} arrows between crates were seen");
}

/// No file uses a file that uses it in turn, directly or through others.
#[test]
fn files_form_no_circle() {
    let mut circles = Vec::new();
    for name in CRATES.iter().chain(&DOORS) {
        let arrows = Modules::of(name).arrows();
        let seen: usize = arrows.values().map(BTreeSet::len).sum();
        assert!(
            seen + 1 >= arrows.len(),
            "{name}: only {seen} arrows between {} files",
            arrows.len()
        );
        if let Some(way) = circle(&arrows) {
            let way: Vec<String> = way.iter().map(|module| module.join("::")).collect();
            circles.push(format!("{name}: {}", way.join(" -> ")));
        }
    }
    assert!(circles.is_empty(), "{circles:#?}");
}

/// In a library a module uses only modules that are declared above it, in `lib.rs` and in each
/// folder.
#[test]
fn a_module_uses_those_above_it() {
    let mut below = Vec::new();
    for name in CRATES {
        let modules = Modules::of(name);
        let place = |module: &Module| modules.order.iter().position(|other| other == module);
        for (module, used) in modules.arrows() {
            let wrong = used.iter().filter(|used| place(used) > place(&module));
            below.extend(wrong.map(|used| {
                format!("{name}: {} uses {} below it", module.join("::"), used.join("::"))
            }));
        }
    }
    assert!(below.is_empty(), "{below:#?}");
}

/// Every link of the walk in ARCHITECTURE.md and of the README leads to a file.
#[test]
fn links_of_the_overview_lead_somewhere() {
    let root = folder("cg-core").join("../..");
    let mut links = 0;
    for page in ["ARCHITECTURE.md", "README.md"] {
        for link in read(&root.join(page)).split("](").skip(1) {
            let target = link.split([')', '#']).next().unwrap();
            if !target.is_empty() && !target.contains("://") {
                assert!(root.join(target).exists(), "{page} links to {target}, which is not there");
                links += 1;
            }
        }
    }
    assert!(links > 20, "only {links} links were seen");
}

/// Cargo does not look for tests here (`autotests = false`): a file that nobody names would not run.
#[test]
fn every_file_of_tests_belongs_to_a_program() {
    let mut files = 0;
    for name in CRATES.iter().chain(&DOORS) {
        let manifest = read(&folder(name).join("Cargo.toml"));
        for tests in ["tests", "tests/cli"].map(|tests| folder(name).join(tests)) {
            if !tests.join("main.rs").exists() {
                continue;
            }
            let program = read(&tests.join("main.rs"));
            for entry in std::fs::read_dir(&tests).unwrap() {
                let path = entry.unwrap().path();
                let stem = path.file_stem().unwrap().to_str().unwrap();
                let of_rust = path.extension().is_some_and(|ending| ending == "rs");
                if of_rust && stem != "main" {
                    let named = program.lines().any(|line| line == format!("mod {stem};"))
                        || manifest.contains(&format!("[[test]]\nname = \"{stem}\"\n"));
                    assert!(named, "no program has the tests of {}", path.display());
                    files += 1;
                }
            }
        }
    }
    assert!(files > 80, "only {files} files were seen");
}

/// No crate holds more than a quarter of the source lines, and files stay short.
#[test]
fn no_crate_is_half_the_house() {
    let mut files = Vec::new();
    let mut lines_of = BTreeMap::new();
    for name in CRATES.iter().chain(&DOORS) {
        for file in Modules::of(name).files.values() {
            let lines = read(file).lines().count();
            files.push(lines);
            *lines_of.entry(*name).or_insert(0) += lines;
            assert!(lines <= 500, "{} has {lines} lines", file.display());
        }
    }
    let all: usize = lines_of.values().sum();
    for (name, lines) in lines_of {
        assert!(4 * lines <= all, "{name} holds {lines} of {all} source lines");
    }
    files.sort_unstable();
    let median = files[files.len() / 2];
    assert!(median <= 200, "the median file has {median} lines");
}
