"""The language server through its protocol, as an editor talks to it."""

import json
import subprocess
import sys

import pytest

pytest.importorskip("pygls", reason="the language server needs pygls")

URI = "file:///models/t%C3%A4nk.hys"
TEXT = """SYSTEM tank{INTERFACE{STATE{REAL level[0,10];/* [m] 😀 */REAL other[0,1];}}
IMPLEMENTATION{CONTINUOUS{level=0.5*level;other=other;}}}
"""


class Client:
    """Speaks the protocol over the pipes of a server."""

    def __init__(self):
        self.process = subprocess.Popen(
            [sys.executable, "-m", "hysdel_py", "lsp"],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        self.number = 0

    def send(self, message):
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        self.process.stdin.write(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))
        self.process.stdin.flush()

    def receive(self, wanted):
        while True:
            length = 0
            while line := self.process.stdout.readline().strip():
                if line.lower().startswith(b"content-length:"):
                    length = int(line.split(b":")[1])
            assert length, "the server has ended"
            message = json.loads(self.process.stdout.read(length))
            if wanted(message):
                return message

    def notify(self, method, params):
        self.send({"method": method, "params": params})

    def ask(self, method, params):
        self.number += 1
        self.send({"id": self.number, "method": method, "params": params})
        answer = self.receive(lambda message: message.get("id") == self.number)
        return answer["error"] if "error" in answer else answer["result"]

    def at(self, method, line, column, **more):
        place = {"textDocument": {"uri": URI}, "position": {"line": line, "character": column}}
        return self.ask(f"textDocument/{method}", place | more)

    def diagnostics(self):
        return self.receive(lambda m: m.get("method") == "textDocument/publishDiagnostics")["params"]["diagnostics"]


@pytest.fixture(scope="module")
def client():
    found = Client()
    capabilities = found.ask("initialize", {"processId": None, "rootUri": None, "capabilities": {}})["capabilities"]
    assert capabilities["hoverProvider"]
    assert capabilities["documentFormattingProvider"]
    found.notify("initialized", {})
    document = {"uri": URI, "languageId": "hysdel", "version": 1, "text": TEXT}
    found.notify("textDocument/didOpen", {"textDocument": document})
    assert found.diagnostics() == []
    yield found
    assert found.ask("shutdown", None) is None
    found.notify("exit", None)
    assert found.process.wait(timeout=20) == 0


def spot(line, start, end):
    return {"start": {"line": line, "character": start}, "end": {"line": line, "character": end}}


def test_hover(client):
    shown = client.at("hover", 1, 27)
    assert shown["contents"]["value"].startswith("**level**: real state in [0, 10] [m]")
    assert shown["range"] == spot(1, 26, 31)
    assert client.at("hover", 0, 0) is None


def test_definition_counts_in_utf16(client):
    assert client.at("definition", 1, 43) == {"uri": URI, "range": spot(0, 62, 67)}


def test_references(client):
    found = client.at("references", 1, 27, context={"includeDeclaration": False})
    assert [place["range"] for place in found] == [spot(1, 26, 31), spot(1, 36, 41)]


def test_rename(client):
    edits = client.at("rename", 1, 27, newName="height")["changes"][URI]
    assert [edit["range"] for edit in edits] == [spot(0, 33, 38), spot(1, 26, 31), spot(1, 36, 41)]
    assert {edit["newText"] for edit in edits} == {"height"}
    assert "already in use" in client.at("rename", 1, 27, newName="other")["message"]


def test_completion(client):
    found = {item["label"]: item for item in client.at("completion", 1, 37)}
    assert found["level"]["detail"] == "REAL STATE"
    assert "sin" in found


def test_symbols(client):
    found = client.ask("textDocument/documentSymbol", {"textDocument": {"uri": URI}})
    assert [(entry["name"], [c["name"] for c in entry["children"]]) for entry in found] == [
        ("STATE", ["level", "other"]), ("CONTINUOUS", []),
    ]  # fmt: skip


def test_formatting(client):
    options = {"tabSize": 2, "insertSpaces": True}
    edits = client.ask("textDocument/formatting", {"textDocument": {"uri": URI}, "options": options})
    assert len(edits) == 1
    assert "\n      level = 0.5*level;\n" in edits[0]["newText"]
    assert edits[0]["range"]["end"] == {"line": 2, "character": 0}


def test_diagnostics_while_typing(client):
    def change(start, end, text, version):
        changes = [{"range": spot(1, start, end), "text": text}]
        document = {"uri": URI, "version": version}
        client.notify("textDocument/didChange", {"textDocument": document, "contentChanges": changes})
        return client.diagnostics()

    (found,) = change(36, 41, "levle", 2)
    assert (found["code"], found["severity"], found["range"]) == ("HYS201", 1, spot(1, 36, 41))
    assert "did you mean level?" in found["message"]
    assert change(36, 41, "level", 3) == []
