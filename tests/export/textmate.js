// Tokenizes the standard input by a TextMate grammar as VS Code does; prints [text, innermost scope] pairs as JSON.
// usage: node textmate.js FOLDER_WITH_NODE_MODULES GRAMMAR
const fs = require("fs");
const path = require("path");
const [folder, grammarFile] = process.argv.slice(2);
const modules = path.join(folder, "node_modules");
const textmate = require(path.join(modules, "vscode-textmate"));
const oniguruma = require(path.join(modules, "vscode-oniguruma"));

async function main() {
  await oniguruma.loadWASM(fs.readFileSync(path.join(modules, "vscode-oniguruma", "release", "onig.wasm")).buffer);
  const registry = new textmate.Registry({
    onigLib: Promise.resolve({
      createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
      createOnigString: (text) => new oniguruma.OnigString(text),
    }),
    loadGrammar: async () => textmate.parseRawGrammar(fs.readFileSync(grammarFile, "utf8"), grammarFile),
  });
  const grammar = await registry.loadGrammar("source.hysdel");
  const pairs = [];
  let state = textmate.INITIAL;
  for (const line of fs.readFileSync(0, "utf8").split("\n")) {
    const result = grammar.tokenizeLine(line, state);
    for (const token of result.tokens) {
      pairs.push([line.slice(token.startIndex, token.endIndex).trim(), token.scopes[token.scopes.length - 1]]);
    }
    state = result.ruleStack;
  }
  console.log(JSON.stringify(pairs.filter(([text]) => text)));
}

main();
