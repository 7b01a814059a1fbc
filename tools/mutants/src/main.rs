//! All mutants of a file in one file, each chosen by `crate::mutant(id)`: one build instead of one a mutant.
//!
//! `mutants-in-one FILE LIST OUT` reads LIST, the mutants of FILE as `cargo mutants --list --json` has them with an `id` added, writes
//! OUT, and prints the ids that it found no place for (in constants, say). `tools/mutants.py` builds those one by one.

use std::collections::BTreeMap;

use proc_macro2::{LineColumn, TokenStream};
use quote::{ToTokens, quote};
use syn::spanned::Spanned;
use syn::visit_mut::{self, VisitMut};
use syn::{Arm, Block, Expr, ExprBinary, UnOp, parse_quote};

/// Line and column, both from 1.
type Place = (usize, usize);

struct Mutant {
    id: usize,
    genre: String,
    replacement: TokenStream,
}

/// Rewrites a file from the inside out.
struct Rewriter {
    mutants: BTreeMap<Place, Vec<Mutant>>,
    placed: Vec<usize>,
}

/// `each` of the first mutant that is switched on, `plain` where none is.
fn switch(
    mutants: &[(usize, TokenStream)],
    each: impl Fn(&TokenStream) -> TokenStream,
    plain: TokenStream,
) -> TokenStream {
    mutants.iter().rev().fold(quote! { { #plain } }, |rest, (id, replacement)| {
        let changed = each(replacement);
        quote! { { if crate::mutant(#id) { #changed } else #rest } }
    })
}

impl Rewriter {
    /// Mutants of this genre at a place: id and replacement.
    fn take(&mut self, at: LineColumn, genre: &str) -> Vec<(usize, TokenStream)> {
        let here = self.mutants.get(&(at.line, at.column + 1)).into_iter().flatten();
        let found: Vec<_> =
            here.filter(|m| m.genre == genre).map(|m| (m.id, m.replacement.clone())).collect();
        self.placed.extend(found.iter().map(|(id, _)| id));
        found
    }

    /// Those that return a constant in place of a function's body.
    fn constants(&mut self, block: &Block) -> Vec<(usize, TokenStream)> {
        block.stmts.first().map_or(vec![], |first| self.take(first.span().start(), "FnValue"))
    }
}

/// Returns the constant first thing.
fn return_early(block: &mut Block, constants: &[(usize, TokenStream)]) {
    for (id, value) in constants {
        block.stmts.insert(0, parse_quote! { if crate::mutant(#id) { return #value; } });
    }
}

/// `a op b` with its operator by switch. Operands are evaluated once, but where the operator decides whether they are at all.
fn binary(ExprBinary { left: a, op, right: b, .. }: &ExprBinary, mutants: &[(usize, TokenStream)]) -> Expr {
    let text = op.to_token_stream().to_string();
    match text.as_str() {
        "&&" | "||" => {
            let all = switch(mutants, |op| quote! { (#a) #op (#b) }, quote! { (#a) #op (#b) });
            parse_quote! { (#all) }
        }
        "==" | "!=" | "<" | "<=" | ">" | ">=" => {
            let all = switch(mutants, |op| quote! { (*left #op *right) }, quote! { (*left #op *right) });
            parse_quote! { (match (&(#a), &(#b)) { (left, right) => #all }) }
        }
        _ if text.ends_with('=') => {
            let all = switch(mutants, |op| quote! { #a #op right }, quote! { #a #op right });
            parse_quote! { { let right = #b; #all } }
        }
        _ => {
            let all = switch(mutants, |op| quote! { (left #op right) }, quote! { (left #op right) });
            parse_quote! { (match ((#a), (#b)) { (left, right) => #all }) }
        }
    }
}

impl VisitMut for Rewriter {
    // Nothing can be switched in a constant or a type.
    fn visit_item_const_mut(&mut self, _: &mut syn::ItemConst) {}
    fn visit_impl_item_const_mut(&mut self, _: &mut syn::ImplItemConst) {}
    fn visit_item_static_mut(&mut self, _: &mut syn::ItemStatic) {}
    fn visit_type_mut(&mut self, _: &mut syn::Type) {}
    fn visit_pat_mut(&mut self, _: &mut syn::Pat) {}

    fn visit_item_fn_mut(&mut self, item: &mut syn::ItemFn) {
        let constants = self.constants(&item.block);
        visit_mut::visit_item_fn_mut(self, item);
        return_early(&mut item.block, &constants);
    }

    fn visit_impl_item_fn_mut(&mut self, item: &mut syn::ImplItemFn) {
        let constants = self.constants(&item.block);
        visit_mut::visit_impl_item_fn_mut(self, item);
        return_early(&mut item.block, &constants);
    }

    fn visit_arm_mut(&mut self, arm: &mut Arm) {
        let deleted = self.take(arm.span().start(), "MatchArm");
        let guards = match &arm.guard {
            Some((_, guard)) => self.take(guard.span().start(), "MatchArmGuard"),
            None => vec![],
        };
        visit_mut::visit_arm_mut(self, arm);
        if let Some((_, guard)) = arm.guard.as_mut().filter(|_| !guards.is_empty()) {
            let all = switch(&guards, TokenStream::clone, guard.to_token_stream());
            **guard = parse_quote! { #all };
        }
        for (id, _) in deleted {
            let guard: Expr = match &arm.guard {
                Some((_, guard)) => parse_quote! { !crate::mutant(#id) && (#guard) },
                None => parse_quote! { !crate::mutant(#id) },
            };
            arm.guard = Some((Default::default(), Box::new(guard)));
        }
    }

    fn visit_expr_mut(&mut self, expr: &mut Expr) {
        let mutants = match expr {
            Expr::Binary(ExprBinary { op, .. }) => self.take(op.span().start(), "BinaryOperator"),
            Expr::Unary(unary) => self.take(unary.op.span().start(), "UnaryOperator"),
            _ => vec![],
        };
        visit_mut::visit_expr_mut(self, expr);
        match expr {
            _ if mutants.is_empty() => {}
            Expr::Binary(whole) => *expr = binary(whole, &mutants),
            Expr::Unary(unary) if !matches!(unary.op, UnOp::Deref(_)) => {
                let (op, x) = (&unary.op, &unary.expr);
                let all = switch(&mutants, |_| quote! { (value) }, quote! { (#op value) });
                *expr = parse_quote! { (match (#x) { value => #all }) };
            }
            _ => {}
        }
    }
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let [_, file, list, out] = args.as_slice() else { panic!("mutants-in-one FILE LIST OUT") };
    let read = |path: &String| std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{path}: {e}"));
    let list: Vec<serde_json::Value> = serde_json::from_str(&read(list)).expect("a list of mutants");
    let number = |value: &serde_json::Value| value.as_u64().expect("a number") as usize;
    let text = |value: &serde_json::Value| value.as_str().expect("a string").to_string();
    let mut rewriter = Rewriter { mutants: BTreeMap::new(), placed: vec![] };
    for m in &list {
        let start = &m["span"]["start"];
        let replacement = text(&m["replacement"]).parse().expect("Rust");
        let mutant = Mutant { id: number(&m["id"]), genre: text(&m["genre"]), replacement };
        rewriter.mutants.entry((number(&start["line"]), number(&start["column"]))).or_default().push(mutant);
    }
    let mut parsed = syn::parse_file(&read(file)).expect("Rust");
    rewriter.visit_file_mut(&mut parsed);
    std::fs::write(out, parsed.to_token_stream().to_string()).expect("a writable file");
    let ids = list.iter().map(|m| number(&m["id"]));
    let missing: Vec<usize> = ids.filter(|id| !rewriter.placed.contains(id)).collect();
    println!("{missing:?}");
}
