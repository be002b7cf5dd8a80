//! Chromium without a window, driven by the DevTools protocol over pipes: a command and its answer are JSON
//! objects that end in a zero byte.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::MutexGuard;
use std::time::{Duration, Instant};

/// Names under which browsers are installed.
const NAMES: [&str; 7] = [
    "chromium",
    "chromium-browser",
    "chromium-headless-shell",
    "chrome-headless-shell",
    "google-chrome",
    "google-chrome-stable",
    "chrome",
];
const MAC: &str = "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome";

/// The browser: what the variable CHROME names, or one with a usual name.
pub fn find() -> Option<PathBuf> {
    if let Some(path) = std::env::var_os("CHROME") {
        return Some(path.into());
    }
    let folders = std::env::var_os("PATH").unwrap_or_default();
    let installed = std::env::split_paths(&folders).flat_map(|folder| NAMES.map(|name| folder.join(name)));
    installed.chain([PathBuf::from(MAC)]).find(|path| path.is_file())
}

/// A browser with one page, and what went wrong in it.
pub struct Page {
    child: Child,
    commands: ChildStdin,
    answers: BufReader<ChildStdout>,
    session: Option<String>,
    number: u64,
    /// Errors and warnings of the console, and exceptions.
    pub complaints: Vec<String>,
    _alone: MutexGuard<'static, ()>,
}

impl Page {
    pub fn open(browser: &Path, profile: &Path, alone: MutexGuard<'static, ()>) -> Self {
        // The shell moves the pipes to where the browser looks for them.
        let mut child = Command::new("sh")
            .args(["-c", "exec \"$0\" \"$@\" 3<&0 4>&1 </dev/null >/dev/null 2>&1"])
            .arg(browser)
            .args([
                "--headless",
                "--no-sandbox",
                "--remote-debugging-pipe",
                "--no-first-run",
                "--hide-scrollbars",
            ])
            .args(["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-gpu-rasterization"])
            .arg(format!("--user-data-dir={}", profile.display()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let (commands, answers) = (child.stdin.take().unwrap(), BufReader::new(child.stdout.take().unwrap()));
        let mut page = Self {
            child,
            commands,
            answers,
            session: None,
            number: 0,
            complaints: Vec::new(),
            _alone: alone,
        };
        let target = page.send("Target.createTarget", json!({ "url": "about:blank" }));
        let attached =
            page.send("Target.attachToTarget", json!({ "targetId": target["targetId"], "flatten": true }));
        page.session = Some(attached["sessionId"].as_str().unwrap().to_owned());
        for domain in ["Page", "Runtime", "Log"] {
            page.send(&format!("{domain}.enable"), json!({}));
        }
        page
    }

    /// Sends a command and waits for its answer.
    pub fn send(&mut self, method: &str, parameters: Value) -> Value {
        self.number += 1;
        let mut message = json!({ "id": self.number, "method": method, "params": parameters });
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        self.commands.write_all(message.to_string().as_bytes()).unwrap();
        self.commands.write_all(&[0]).unwrap();
        self.commands.flush().unwrap();
        loop {
            let message = self.next();
            if message["id"] == self.number {
                assert!(message["error"].is_null(), "{method}: {message}");
                return message["result"].clone();
            }
        }
    }

    fn next(&mut self) -> Value {
        let mut bytes = Vec::new();
        self.answers.read_until(0, &mut bytes).unwrap();
        assert_eq!(bytes.pop(), Some(0), "the browser ended");
        let message: Value = serde_json::from_slice(&bytes).unwrap();
        let parameters = &message["params"];
        match message["method"].as_str() {
            Some("Runtime.exceptionThrown") => {
                self.complaints.push(parameters["exceptionDetails"].to_string())
            }
            Some("Runtime.consoleAPICalled")
                if parameters["type"] == "error" || parameters["type"] == "warning" =>
            {
                self.complaints.push(parameters["args"].to_string());
            }
            Some("Log.entryAdded") if parameters["entry"]["level"] == "error" => {
                self.complaints.push(parameters["entry"].to_string());
            }
            _ => {}
        }
        message
    }

    /// Opens a file in a window of this size and scheme of colours, drawn with half of the pixels each way:
    /// without a graphics card their number takes the time.
    pub fn show(&mut self, file: &Path, size: (u32, u32), scheme: &str) {
        self.show_scaled(file, size, scheme, 0.5);
    }

    /// The same with all pixels, for pictures.
    pub fn show_sharply(&mut self, file: &Path, size: (u32, u32), scheme: &str) {
        self.show_scaled(file, size, scheme, 1.0);
    }

    fn show_scaled(&mut self, file: &Path, (width, height): (u32, u32), scheme: &str, scale: f64) {
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": scale, "mobile": false });
        self.send("Emulation.setDeviceMetricsOverride", size);
        let features = json!({ "features": [{ "name": "prefers-color-scheme", "value": scheme }] });
        self.send("Emulation.setEmulatedMedia", features);
        self.send("Page.navigate", json!({ "url": format!("file://{}", file.display()) }));
        self.wait("document.readyState === 'complete' && window.costateReport !== undefined");
    }

    /// The value of an expression, or of its promise.
    pub fn value(&mut self, expression: &str) -> Value {
        let parameters = json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let answer = self.send("Runtime.evaluate", parameters);
        assert!(answer["exceptionDetails"].is_null(), "{expression}: {answer}");
        answer["result"]["value"].clone()
    }

    /// Waits until an expression is true.
    pub fn wait(&mut self, expression: &str) {
        let begun = Instant::now();
        while self.value(expression) != true {
            assert!(
                begun.elapsed() < Duration::from_secs(60),
                "never true: {expression}; {:?}",
                self.complaints
            );
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// The middle of an element in the window, after scrolling to it.
    pub fn place(&mut self, selector: &str) -> [f64; 2] {
        let place = self.value(&format!(
            "(() => {{ const e = document.querySelector({selector:?}); \
             e.scrollIntoView({{ block: 'center' }}); const r = e.getBoundingClientRect(); \
             return [r.left + r.width / 2, r.top + r.height / 2]; }})()"
        ));
        [0, 1].map(|k| place[k].as_f64().unwrap())
    }

    /// Sends an event of the mouse with its left button.
    pub fn mouse(&mut self, kind: &str, at: [f64; 2], clicks: u32) {
        self.mouse_with(kind, at, clicks, 0);
    }

    /// The same with keys that are held.
    fn mouse_with(&mut self, kind: &str, [x, y]: [f64; 2], clicks: u32, modifiers: u32) {
        let button = if kind == "mouseMoved" && clicks == 0 { "none" } else { "left" };
        let buttons = u32::from(kind != "mouseReleased" && clicks > 0);
        let event = json!({ "type": kind, "x": x, "y": y, "button": button, "buttons": buttons, "clickCount": clicks, "modifiers": modifiers });
        self.send("Input.dispatchMouseEvent", event);
    }

    /// Clicks at a place of the window.
    pub fn click_at(&mut self, at: [f64; 2], clicks: u32) {
        self.mouse("mouseMoved", at, 0);
        for click in 1..=clicks {
            self.mouse("mousePressed", at, click);
            self.mouse("mouseReleased", at, click);
        }
    }

    /// Clicks an element in its middle.
    pub fn click(&mut self, selector: &str) {
        let at = self.place(selector);
        self.click_at(at, 1);
    }

    /// Drags from one place to another.
    pub fn drag(&mut self, from: [f64; 2], to: [f64; 2]) {
        self.drag_with(from, to, 0);
    }

    /// The same with keys that are held, by the bits of the protocol.
    pub fn drag_with(&mut self, from: [f64; 2], to: [f64; 2], modifiers: u32) {
        self.mouse_with("mouseMoved", from, 0, modifiers);
        self.mouse_with("mousePressed", from, 1, modifiers);
        for part in [0.5, 1.0] {
            let at = [0, 1].map(|k| from[k] + part * (to[k] - from[k]));
            self.mouse_with("mouseMoved", at, 1, modifiers);
        }
        self.mouse_with("mouseReleased", to, 1, modifiers);
    }

    /// Presses a key.
    pub fn key(&mut self, key: &str) {
        let text = if key == " " { json!(" ") } else { Value::Null };
        let mut down = json!({ "type": "keyDown", "key": key });
        if !text.is_null() {
            down["text"] = text;
        }
        self.send("Input.dispatchKeyEvent", down);
        self.send("Input.dispatchKeyEvent", json!({ "type": "keyUp", "key": key }));
    }

    /// A picture of the whole page (PNG), for people to look at.
    pub fn picture(&mut self) -> Vec<u8> {
        let parameters = json!({ "format": "png", "captureBeyondViewport": true });
        let picture = self.send("Page.captureScreenshot", parameters);
        bytes(picture["data"].as_str().unwrap())
    }
}

/// The bytes of a text in base 64 (RFC 4648).
fn bytes(text: &str) -> Vec<u8> {
    let digits: Vec<u32> = text
        .bytes()
        .filter_map(|letter| match letter {
            b'A'..=b'Z' => Some(letter - b'A'),
            b'a'..=b'z' => Some(letter - b'a' + 26),
            b'0'..=b'9' => Some(letter - b'0' + 52),
            b'+' => Some(62),
            b'/' => Some(63),
            _ => None,
        })
        .map(u32::from)
        .collect();
    let four = |four: &[u32]| -> Vec<u8> {
        let bits = four.iter().enumerate().fold(0, |bits, (k, digit)| bits | digit << (18 - 6 * k));
        [16, 8, 0].iter().take(four.len() - 1).map(|shift| (bits >> shift) as u8).collect()
    };
    digits.chunks(4).flat_map(four).collect()
}

impl Drop for Page {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
        let _ = self.answers.read_to_end(&mut Vec::new());
    }
}
