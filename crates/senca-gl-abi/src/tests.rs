//! The tables against the system's headers.

use std::collections::BTreeMap;

/// Versions of which everything must be there, as of all extensions that are told.
const SECTIONS: [&str; 4] = ["GL_VERSION_1_2", "GL_VERSION_1_3", "GL_VERSION_1_4", "GL_VERSION_1_5"];

/// A header of the system; `None` where there are no headers.
fn header(name: &str) -> Option<String> {
    std::fs::read_to_string(format!("/usr/include/GL/{name}")).ok()
}

/// `name -> signature` of all prototypes in a piece of a header.
fn prototypes(text: &str) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for piece in text.split("GLAPI ").skip(1) {
        let Some((declaration, _)) = piece.split_once(';') else { continue };
        let Some((result, rest)) = declaration.split_once("APIENTRY") else { continue };
        let Some((name, parameters)) = rest.split_once('(') else { continue };
        let parameters = parameters.trim_end().trim_end_matches(')');
        let result = rust_type(result.trim().trim_end_matches("GL").trim());
        let all = parameters.split(',').map(str::trim).filter(|p| !matches!(*p, "void" | ""));
        let types: String = all.map(|p| rust_type(without_name(p)) + ";").collect();
        let result = if result == "()" { String::new() } else { result };
        found.insert(name.trim().to_owned(), format!("{types}->{result}"));
    }
    found
}

/// A parameter without the name at its end; an array is a pointer.
fn without_name(parameter: &str) -> &str {
    let parameter = parameter.split('[').next().unwrap_or(parameter);
    parameter.trim_end_matches(|c: char| c.is_alphanumeric() || c == '_').trim()
}

/// The type of the tables for one of C; pointers only say which way.
fn rust_type(c: &str) -> String {
    let c = c.replace("const*", "*").replace("GLvoid", "void");
    if c.contains('*') {
        return if c.trim_start().starts_with("const") { "In" } else { "Out" }.to_owned();
    }
    match c.trim() {
        "void" => "()",
        "GLenum" | "GLuint" | "GLbitfield" => "u32",
        "GLint" | "GLsizei" => "i32",
        "GLfloat" | "GLclampf" => "f32",
        "GLdouble" | "GLclampd" => "f64",
        "GLbyte" => "i8",
        "GLshort" => "i16",
        "GLubyte" | "GLboolean" => "u8",
        "GLushort" => "u16",
        "GLintptr" | "GLsizeiptr" | "GLintptrARB" | "GLsizeiptrARB" => "isize",
        "GLDEBUGPROC" => "Option<Callback>",
        other => other,
    }
    .to_owned()
}

/// A signature of the tables, pointers told by their direction only.
fn plain(signature: &str) -> String {
    let direction = |t: &str| match t.replace(' ', "") {
        t if t.starts_with("In<") || t == "Pointer" || t.starts_with("*const") => "In".to_owned(),
        t if t.starts_with("Out<") || t.starts_with("*mut") => "Out".to_owned(),
        t => t,
    };
    let (parameters, result) = signature.split_once("->").unwrap();
    let types: String = parameters.split_terminator(';').map(|t| direction(t.trim()) + ";").collect();
    format!("{types}->{}", direction(result.trim()))
}

/// Prototypes of what must be there; `None` without headers.
fn wanted() -> Option<BTreeMap<String, String>> {
    let (gl, ext) = (header("gl.h")?, header("glext.h")?);
    let imaging = gl.split("\n * GL_ARB_imaging\n").next().unwrap_or_default();
    let mut wanted = prototypes(imaging);
    for section in SECTIONS.iter().chain(senca_gl::EXTENSIONS) {
        let begin = ext.find(&format!("#ifndef {section}\n"));
        let end = ext.find(&format!("#endif /* {section} */"));
        wanted.extend(begin.zip(end).map(|(begin, end)| prototypes(&ext[begin..end])).unwrap_or_default());
    }
    Some(wanted)
}

#[test]
fn every_function_of_the_headers_is_there_with_its_types() {
    let Some(wanted) = wanted() else {
        return;
    };
    assert!(wanted.len() > 500, "{}", wanted.len());
    let mut wrong = Vec::new();
    for (name, signature) in &wanted {
        match crate::commands::find(name) {
            None => wrong.push(format!("{name} is missing")),
            Some(e) if plain(e.signature) != *signature => {
                wrong.push(format!("{name} is {} instead of {signature}", plain(e.signature)));
            }
            Some(_) => {}
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), wanted.len(), wrong.join("\n"));
}

#[test]
fn no_name_is_twice_in_the_tables() {
    let mut names: Vec<&str> = crate::commands::tables().map(|e| e.name).collect();
    let all = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), all);
    assert!(names.iter().all(|n| n.starts_with("gl")));
}

#[test]
fn unknown_names_have_no_function() {
    assert!(crate::commands::find("glNoSuchCommand").is_none());
    assert!(crate::commands::find("glClear").is_some());
}
