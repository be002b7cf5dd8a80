# Prints one circle of imports between the files of a crate, if there is any.
# Usage: awk -v root=FOLDER_OF_THE_ROOT -f .ci/circles.awk FILES; with -v all=1 it prints all imports that remain.
#
# A file imports another if a path that begins with `crate`, `self`, `super` or a module of its own leads there, in a
# `use` or in an expression. `mod` imports nothing, and neither does `pub use` of what the file itself does not use:
# names are followed to the file that defines them. Skipped are tests, comments, and modules in other folders
# (`#[path = ...]`).

# The module of a file: `a::b` for `a/b.rs` and `a/b/mod.rs`, the empty name for the root.
function module_of(file) {
    file = substr(file, length(root) + 2)
    sub(/\.rs$/, "", file)
    sub(/(^|\/)(mod|lib|main)$/, "", file)
    gsub(/\//, "::", file)
    return file
}
function child(module, name) { return module == "" ? name : module "::" name }
function parent(module) { return sub(/::[^:]*$/, "", module) ? module : "" }

# The module where a path ends that begins in `module`; "?" outside of the crate.
function resolve(module, path, depth,    parts, count, i, at, name, next_path) {
    count = split(path, parts, "::")
    at = module
    for (i = 1; i <= count; i++) {
        name = parts[i]
        if (i == 1 && name == "crate") at = ""
        else if (name == "self") continue
        else if (name == "super") at = parent(at)
        else if (child(at, name) in file_of) at = child(at, name)
        else if ((at, name) in elsewhere) return "?"
        else if ((at, name) in alias && depth < 8) {
            next_path = alias[at, name]
            for (i++; i <= count; i++) next_path = next_path "::" parts[i]
            return resolve(at, next_path, depth + 1)
        } else if (i == 1) return "?"
        else return at
    }
    return at
}

# Splits a tree of imports `a::{b, c::{d as e}}` into paths and records them.
function expand(prefix, tree, module, is_public,    i, c, level, start, open, part, name) {
    gsub(/^ +| +$/, "", tree)
    if (tree == "") return
    open = index(tree, "{")
    if (!open) {
        name = tree
        if (tree ~ / as /) { sub(/.* as /, "", name); sub(/ as .*/, "", tree) }
        tree = prefix tree
        sub(/::self$/, "", tree)
        if (name == "self") name = tree
        sub(/.*::/, "", name)
        uses++
        use_module[uses] = module
        use_path[uses] = tree
        use_name[uses] = is_public ? name : ""
        if (name != "*" && tree != name) alias[module, name] = tree
        return
    }
    part = substr(tree, 1, open - 1)
    sub(/\}[^}]*$/, "", tree)
    tree = substr(tree, open + 1) ","
    level = 0
    start = 1
    for (i = 1; i <= length(tree); i++) {
        c = substr(tree, i, 1)
        if (c == "{") level++
        else if (c == "}") level--
        else if (c == "," && level == 0) {
            expand(prefix part, substr(tree, start, i - start), module, is_public)
            start = i + 1
        }
    }
}

function imports(from, to) {
    if (to != "?" && to in file_of && to != from) edge[from, to] = 1
}

FNR == 1 { own = module_of(FILENAME); file_of[own] = FILENAME; tests = 0; held = 0; statement = "" }
/^ *#\[cfg\(test\)\]/ { held = FNR }
/^ *(pub )?mod [a-z_]+ \{/ && held == FNR - 1 { tests = 1 }
tests { next }
{ line = $0; sub(/\/\/.*/, "", line) }
/^#\[path = / { elsewhere_next = 1 }
line ~ /^ *(pub(\([a-z]+\))? )?mod [a-z_]+;/ {
    name = line
    sub(/.*mod /, "", name)
    sub(/;.*/, "", name)
    if (elsewhere_next) elsewhere[own, name] = 1
    elsewhere_next = 0
    next
}
statement == "" && line ~ /^ *(pub(\([a-z]+\))? )?use / { statement = " " }
statement != "" {
    statement = statement " " line
    if (line !~ /;/) next
    is_public = statement ~ /^ *pub/
    sub(/^ *(pub(\([a-z]+\))? )?use /, "", statement)
    sub(/;.*/, "", statement)
    gsub(/ +/, " ", statement)
    expand("", statement, own, is_public)
    statement = ""
    next
}
{
    count = split(line, found, /[^A-Za-z0-9_]+/)
    for (i = 1; i <= count; i++) words[own, found[i]] = 1
    while (match(line, /[a-z_]+(::[A-Za-z0-9_]+)+/)) {
        if (substr(line, RSTART - 1, 1) !~ /[A-Za-z0-9_:$]/) {
            paths++
            path_module[paths] = own
            path_text[paths] = substr(line, RSTART, RLENGTH)
        }
        line = substr(line, RSTART + RLENGTH)
    }
}

END {
    for (i = 1; i <= uses; i++)
        if (use_name[i] == "" || (use_module[i], use_name[i]) in words)
            imports(use_module[i], resolve(use_module[i], use_path[i], 0))
    for (i = 1; i <= paths; i++) imports(path_module[i], resolve(path_module[i], path_text[i], 0))
    # Files that import none of the others, or that none imports, are on no circle.
    do {
        removed = 0
        split("", out)
        split("", in_)
        for (e in edge) { split(e, ends, SUBSEP); out[ends[1]] = ends[2]; in_[ends[2]] = 1 }
        for (e in edge) {
            split(e, ends, SUBSEP)
            if (!(ends[2] in out) || !(ends[1] in in_)) { delete edge[e]; removed = 1 }
        }
    } while (removed)
    if (all) for (e in edge) { split(e, ends, SUBSEP); print file_of[ends[1]], "->", file_of[ends[2]] }
    for (at in out) {
        while (!(at in seen)) { seen[at] = 1; at = out[at] }
        circle = file_of[at]
        for (next_ = out[at]; next_ != at; next_ = out[next_]) circle = circle " -> " file_of[next_]
        print "circle of imports: " circle " -> " file_of[at]
        exit 1
    }
}
