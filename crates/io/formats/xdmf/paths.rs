//! Elements that others stand for: `xi:include` with an XPointer, and `Reference` with an XPath, both within one file.
//!
//! Of XPath what writers of XDMF use: steps of names or `*`, `//` before a step, and conditions on the place, on an attribute and
//! on the element's name (`*[self::Topology or self::Geometry]`). Of XPointer `xpointer(PATH)` and `element(/1/2)`.

use crate::formats::source::Source;
use crate::formats::xml::header::Element;
use std::cell::Cell;
use voltet_core::{Error, Result};

/// Most elements that one path gives, and deepest chain of references.
const MAX_FOUND: usize = 100_000;
const MAX_CHAIN: usize = 16;
/// Most elements that one reading looks at: seconds of work.
const MAX_VISITED: usize = 50_000_000;

/// The elements of a file.
pub(super) struct Document<'a> {
    pub source: &'a Source,
    pub root: &'a Element,
    /// Elements that were looked at so far.
    visited: Cell<usize>,
}

impl<'a> Document<'a> {
    pub fn new(source: &'a Source, root: &'a Element) -> Document<'a> {
        Document { source, root, visited: Cell::new(0) }
    }

    pub fn text(&self, element: &Element) -> Result<String> {
        let mut text = String::new();
        for part in &element.text {
            text += &String::from_utf8_lossy(&self.source.read(part.start, part.end - part.start)?);
        }
        Ok(text.trim().to_owned())
    }

    /// The children of an element, those that are included in the places of the includes.
    pub fn children(&self, element: &'a Element) -> Result<Vec<&'a Element>> {
        self.visit(element.children.len(), &element.tag)?;
        let mut children = Vec::new();
        let mut pending: Vec<(&Element, usize)> =
            element.children.iter().rev().map(|child| (child, 0)).collect();
        while let Some((child, depth)) = pending.pop() {
            if !child.tag.ends_with(":include") {
                children.push(self.resolved(child)?);
            } else if depth > MAX_CHAIN {
                return Err(Error::run("an include includes itself"));
            } else {
                pending.extend(self.included(child)?.into_iter().rev().map(|child| (child, depth + 1)));
            }
        }
        Ok(children)
    }

    pub fn children_of(&self, element: &'a Element, tag: &str) -> Result<Vec<&'a Element>> {
        Ok(self.children(element)?.into_iter().filter(|child| child.tag == tag).collect())
    }

    fn included(&self, include: &'a Element) -> Result<Vec<&'a Element>> {
        if let Some(file) = include.attribute("href").filter(|href| !href.is_empty()) {
            let error =
                Error::run("an include of another file is not followed").got(format_args!("'{file}'"));
            return Err(error.expected("an xpointer into the file itself"));
        }
        let pointer = include.required("xpointer")?.trim();
        let within = |scheme: &str| pointer.strip_prefix(scheme)?.strip_suffix(')');
        match (within("xpointer("), within("element(")) {
            (Some(path), _) => self.find(path),
            (_, Some(places)) => self.place(places),
            _ => Err(include.wrong("xpointer", "xpointer(PATH) or element(/1/2)")),
        }
    }

    /// The element that an element refers to, or itself.
    fn resolved(&self, mut element: &'a Element) -> Result<&'a Element> {
        for _ in 0..MAX_CHAIN {
            let Some(reference) = element.attribute("Reference") else { return Ok(element) };
            let path = if reference == "XML" { self.text(element)? } else { reference.to_owned() };
            element = self.find(&path)?.into_iter().next().ok_or_else(|| nothing(&path))?;
        }
        Err(Error::run("a reference refers to itself").at_item(&element.tag))
    }

    /// Counts elements that are looked at. Errors: they are too many, by whatever includes and references; `path`: the last.
    fn visit(&self, count: usize, path: &str) -> Result<()> {
        self.visited.set(self.visited.get().saturating_add(count));
        match self.visited.get() > MAX_VISITED {
            true => Err(Error::run("the paths in the XML lead to too many elements").got(path)),
            false => Ok(()),
        }
    }

    /// The element by its place among its parent's children, from 1, on each level.
    fn place(&self, places: &str) -> Result<Vec<&'a Element>> {
        let mut steps = places.trim_matches('/').split('/').map(|step| step.parse::<usize>().ok());
        self.visit(places.len(), places)?;
        let mut element = Some(self.root).filter(|_| steps.next() == Some(Some(1)));
        for step in steps {
            element = element.and_then(|element| element.children.get(step?.checked_sub(1)?));
        }
        element.map(|element| vec![element]).ok_or_else(|| nothing(places))
    }

    fn find(&self, path: &str) -> Result<Vec<&'a Element>> {
        let mut steps = split(path).into_iter().peekable();
        let mut found: Option<Vec<&Element>> = None;
        if path.starts_with('/') {
            steps.next();
        }
        while let Some(mut step) = steps.next() {
            let is_deep = step.is_empty();
            if is_deep {
                step = steps.next().unwrap_or("");
            }
            let parents = found.take();
            let mut next = Vec::new();
            for candidates in candidates(self.root, parents, is_deep)? {
                self.visit(candidates.len(), path)?;
                next.extend(selected(candidates, step, path)?);
            }
            if next.len() > MAX_FOUND {
                return Err(Error::run("a path in the XML gives too many elements").got(path));
            }
            found = Some(next);
        }
        found.filter(|found| !found.is_empty()).ok_or_else(|| nothing(path))
    }
}

fn nothing(path: &str) -> Error {
    Error::run("the XML refers to an element that is not there").got(format_args!("'{path}'"))
}

/// Lists of siblings among which a step selects: the root, the children of elements, or all lists below them.
fn candidates<'a>(
    root: &'a Element,
    parents: Option<Vec<&'a Element>>,
    is_deep: bool,
) -> Result<Vec<Vec<&'a Element>>> {
    let of = |parent: &&'a Element| parent.children.iter().collect::<Vec<_>>();
    let mut lists = parents.map_or_else(|| vec![vec![root]], |parents| parents.iter().map(of).collect());
    let mut at = 0;
    while is_deep && at < lists.len() {
        let further: Vec<Vec<&Element>> = lists[at].iter().map(of).filter(|list| !list.is_empty()).collect();
        lists.extend(further);
        at += 1;
        if lists.len() > MAX_FOUND {
            return Err(Error::run("the XML holds too many elements for a path"));
        }
    }
    Ok(lists)
}

/// Siblings that fit a step: a name or `*`, then conditions, each on what the ones before left.
fn selected<'a>(siblings: Vec<&'a Element>, step: &str, path: &str) -> Result<Vec<&'a Element>> {
    let (name, mut conditions) = step.split_at(step.find('[').unwrap_or(step.len()));
    let mut left: Vec<&Element> =
        siblings.into_iter().filter(|element| name == "*" || element.tag == name.trim()).collect();
    while let Some(rest) = conditions.strip_prefix('[') {
        let Some((condition, after)) = rest.split_once(']') else { return Err(unreadable(path)) };
        conditions = after.trim_start();
        if let Ok(place) = condition.trim().parse::<usize>() {
            left = place.checked_sub(1).and_then(|place| left.get(place)).copied().into_iter().collect();
            continue;
        }
        let alternatives: Option<Vec<Condition>> = condition.split(" or ").map(Condition::parse).collect();
        let alternatives = alternatives.ok_or_else(|| unreadable(path))?;
        left.retain(|element| alternatives.iter().any(|condition| condition.holds(element)));
    }
    if conditions.is_empty() { Ok(left) } else { Err(unreadable(path)) }
}

fn unreadable(path: &str) -> Error {
    let error = Error::run("a path in the XML is of a kind that is not read").got(format_args!("'{path}'"));
    error.expected("names, *, //, [number], [@attribute=\"value\"] and [self::name or self::name]")
}

enum Condition<'a> {
    Name(&'a str),
    Attribute(&'a str, &'a str),
}

impl<'a> Condition<'a> {
    fn parse(text: &'a str) -> Option<Condition<'a>> {
        let text = text.trim();
        if let Some(name) = text.strip_prefix("self::") {
            return Some(Condition::Name(name.trim()));
        }
        let (name, value) = text.strip_prefix('@')?.split_once('=')?;
        let value = value.trim();
        let value = value
            .strip_prefix('"')
            .and_then(|rest| rest.strip_suffix('"'))
            .or_else(|| value.strip_prefix('\'')?.strip_suffix('\''))?;
        Some(Condition::Attribute(name.trim(), value))
    }

    fn holds(&self, element: &Element) -> bool {
        match self {
            Condition::Name(name) => element.tag == *name,
            Condition::Attribute(name, value) => element.attribute(name) == Some(value),
        }
    }
}

/// Parts of a path between slashes that stand in no condition.
fn split(path: &str) -> Vec<&str> {
    let (mut parts, mut begin, mut depth) = (Vec::new(), 0, 0_usize);
    for (place, letter) in path.char_indices() {
        match letter {
            '[' => depth += 1,
            ']' => depth = depth.saturating_sub(1),
            '/' if depth == 0 => {
                parts.push(&path[begin..place]);
                begin = place + 1;
            }
            _ => {}
        }
    }
    parts.push(&path[begin..]);
    parts
}
