//! Builds the web page into the program.
//!
//! Hashes the inputs of `web/`; an unknown hash runs `npm ci` (where the lock file changed) and the page's
//! own build into the target folder's cache, shared by debug and release. The result is copied to
//! `$OUT_DIR/web`, from where it is embedded. Nothing is written into the source tree but `web/node_modules`.
//! Without `web/`, without npm, or where the build fails, a page that says so is embedded. `GIVEWAY_WEB=skip`
//! does that too, for the inner loop.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs, io};

/// What the page is built from, below `web/`.
const INPUTS: [&str; 16] = [
    "src",
    "public",
    "index.html",
    "headset.html",
    "docs.html",
    "signin.html",
    "editor.html",
    "station.html",
    "package.json",
    "package-lock.json",
    "vite.config.ts",
    "vite.config.js",
    "svelte.config.js",
    "svelte.config.ts",
    "tsconfig.json",
    "tsconfig.node.json",
];

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=GIVEWAY_WEB");
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    let target = out.join("web");
    let _ = fs::remove_dir_all(&target);
    fs::create_dir_all(&target).expect("the target folder is writable");
    if let Err(why) = page(&out, &target) {
        if env::var("GIVEWAY_WEB").as_deref() != Ok("skip") {
            println!("cargo:warning=the web page is not built in: {why}");
            // A file that never exists: look again at the next build, since the missing parts may be there then.
            println!("cargo:rerun-if-changed=web/.built-again-each-time");
        }
        let text = placeholder(&why);
        fs::write(target.join("index.html"), text).expect("the target folder is writable");
    }
}

/// Builds the page, or takes it from the cache.
fn page(out: &Path, target: &Path) -> Result<(), String> {
    if env::var("GIVEWAY_WEB").as_deref() == Ok("skip") {
        return Err("GIVEWAY_WEB=skip was set at build time".into());
    }
    let root = env::var_os("CARGO_MANIFEST_DIR").ok_or("cargo did not say where the sources are")?;
    let web = Path::new(&root).join("../../web");
    if !web.join("package.json").exists() {
        return Err("there is no web/package.json".into());
    }
    let mut files = Vec::new();
    for input in INPUTS.iter().map(|name| web.join(name)).filter(|path| path.exists()) {
        println!("cargo:rerun-if-changed={}", input.display());
        collect(&input, &mut files).map_err(|e| format!("cannot read {}: {e}", input.display()))?;
    }
    files.sort();
    let cache = cache_folder(out).join(format!("{:016x}", hash(&web, &files)?));
    if !cache.join("index.html").exists() {
        install(&web)?;
        let fresh = cache.with_extension(format!("new-{}", std::process::id()));
        let folder = fresh.to_str().ok_or("the target folder's name is no Unicode")?;
        let vite = ["exec", "--no", "--", "vite", "build", "--emptyOutDir", "--outDir"];
        npm(&web, &[&vite[..], &[folder]].concat())?;
        // Build again in one piece, for pages that are files with a recording in them.
        npm(&web, &[&vite[..], &[&format!("{folder}/single"), "--mode", "single"]].concat())?;
        if fs::rename(&fresh, &cache).is_err() && !cache.join("index.html").exists() {
            return Err(format!("cannot move the page to {}", cache.display()));
        }
        let _ = fs::remove_dir_all(&fresh);
    }
    copy(&cache, target).map_err(|e| format!("cannot copy {}: {e}", cache.display()))
}

/// `target/web-cache`: the target folder is four levels above `OUT_DIR`, and all profiles share it.
fn cache_folder(out: &Path) -> PathBuf {
    let folder = out.ancestors().nth(4).unwrap_or(out).join("web-cache");
    let _ = fs::create_dir_all(&folder);
    folder
}

fn collect(path: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    if path.is_dir() {
        for entry in fs::read_dir(path)? {
            collect(&entry?.path(), files)?;
        }
    } else {
        files.push(path.into());
    }
    Ok(())
}

/// FNV-1a over names and contents: a cache key, not a cryptographic hash.
fn hash(web: &Path, files: &[PathBuf]) -> Result<u64, String> {
    let mut h: u64 = 0xcbf2_9ce4_8422_2325;
    let mut eat = |bytes: &[u8]| {
        for b in (bytes.len() as u64).to_le_bytes().iter().chain(bytes) {
            h = (h ^ u64::from(*b)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    };
    for file in files {
        let name = file.strip_prefix(web).unwrap_or(file);
        eat(name.to_string_lossy().as_bytes());
        eat(&fs::read(file).map_err(|e| format!("cannot read {}: {e}", file.display()))?);
    }
    Ok(h)
}

/// Runs `npm ci`, unless the installed packages are as new as the lock file.
fn install(web: &Path) -> Result<(), String> {
    let age = |path: PathBuf| fs::metadata(path).and_then(|m| m.modified()).ok();
    let lock = age(web.join("package-lock.json"));
    let installed = age(web.join("node_modules/.package-lock.json"));
    if installed.is_some() && installed >= lock {
        return Ok(());
    }
    npm(web, &["ci", "--no-audit", "--no-fund"])
}

fn npm(web: &Path, arguments: &[&str]) -> Result<(), String> {
    let program = if cfg!(windows) { "npm.cmd" } else { "npm" };
    let output = Command::new(program)
        .args(arguments)
        .current_dir(web)
        .output()
        .map_err(|e| format!("cannot run npm ({e}); install Node 20 or newer with npm"))?;
    if output.status.success() {
        return Ok(());
    }
    let text = String::from_utf8_lossy(&output.stderr);
    let last: Vec<_> = text.lines().filter(|l| !l.trim().is_empty()).collect();
    let end = last[last.len().saturating_sub(5)..].join(" | ");
    Err(format!("`npm {}` in web/ failed: {end}", arguments.join(" ")))
}

fn copy(from: &Path, to: &Path) -> io::Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy(&entry.path(), &target)?;
        } else {
            fs::copy(entry.path(), target)?;
        }
    }
    Ok(())
}

fn placeholder(why: &str) -> String {
    let why = why.replace('&', "&amp;").replace('<', "&lt;");
    format!(
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>Giveway</title>\n\
         <h1>Giveway is running</h1>\n<p>Its web page is not in this build: {why}.</p>\n\
         <p>Install Node 20 or newer with npm and build again. The API works: <a href=\"/openapi.json\">its \
         description</a>, <a href=\"/v1/robots\">robots</a>, <a href=\"/v1/jobs\">jobs</a>.</p></html>\n"
    )
}
