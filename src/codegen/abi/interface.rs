//! The functions that CasADi derives from a function f, with the names that it looks for:
//!
//! | function | arguments | results |
//! |---|---|---|
//! | `f` | those of f | those of f |
//! | `jac_f` | the same, `out_*` | a matrix for each result and argument |
//! | `adj1_f` | the same, `adj_*` | `adj_*` for each argument: y'f_z |
//! | `jac_adj1_f` | the same, `out_adj_*` | a matrix for each of these and each argument of `adj1_f` |
//! | `jac_jac_f` | those of `jac_f`, `out_jac_*` | a matrix for each result and argument of `jac_f` |
//!
//! Arguments `out_*` are results that CasADi could pass and that are not needed: they have no entries. So do
//! second derivatives that vanish. Matrices lie column by column.

/// An argument or a result of f: a matrix; vectors have one column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variable {
    /// Its name.
    pub name: &'static str,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
}

impl Variable {
    /// A vector.
    pub fn vector(name: &'static str, rows: usize) -> Self {
        Self { name, rows, columns: 1 }
    }

    /// Number of entries.
    pub fn entries(self) -> usize {
        self.rows * self.columns
    }

    fn port(self, prefix: &str, full: bool) -> Port {
        Port { name: format!("{prefix}{}", self.name), rows: self.rows, columns: self.columns, full }
    }
}

/// An argument or a result of one of the functions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Port {
    /// Its name.
    pub name: String,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// Whether it has entries: all of them, or none.
    pub full: bool,
}

impl Port {
    /// Its sparsity as CasADi reads it: rows and columns, then a one for a dense matrix, or where each column
    /// of one without entries begins.
    pub fn sparsity(&self) -> Vec<usize> {
        let mut sparsity = vec![self.rows, self.columns];
        if self.full {
            sparsity.push(1);
        } else {
            sparsity.resize(self.columns + 3, 0);
        }
        sparsity
    }
}

/// One of the functions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExternalPorts {
    /// What its name begins with.
    pub prefix: &'static str,
    /// Its arguments.
    pub inputs: Vec<Port>,
    /// Its results.
    pub outputs: Vec<Port>,
}

/// A function f.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Interface {
    /// Its arguments.
    pub inputs: Vec<Variable>,
    /// Its results.
    pub outputs: Vec<Variable>,
    /// For each pair of arguments whether the second derivatives in them are not zero by structure.
    pub curved: Vec<Vec<bool>>,
}

impl Interface {
    /// f, its Jacobian, its adjoint and the Jacobian of that.
    pub fn functions(&self) -> [ExternalPorts; 4] {
        let ports = |of: &[Variable], prefix: &str, full| -> Vec<Port> {
            of.iter().map(|variable| variable.port(prefix, full)).collect()
        };
        let inputs = ports(&self.inputs, "", true);
        let spare = ports(&self.outputs, "out_", false);
        let weights = ports(&self.outputs, "adj_", true);
        let products = ports(&self.inputs, "adj_", true);
        let with = |more: &[&[Port]]| [inputs.clone(), more.concat()].concat();
        [
            ExternalPorts { prefix: "", inputs: inputs.clone(), outputs: ports(&self.outputs, "", true) },
            ExternalPorts { prefix: "jac_", inputs: with(&[&spare]), outputs: self.slopes() },
            ExternalPorts { prefix: "adj1_", inputs: with(&[&spare, &weights]), outputs: products },
            ExternalPorts {
                prefix: "jac_adj1_",
                inputs: with(&[&spare, &weights, &ports(&self.inputs, "out_adj_", false)]),
                outputs: self.curvatures(),
            },
        ]
    }

    /// The Jacobian of the Jacobian: all second derivatives of f, not contracted.
    ///
    /// A row belongs to each entry of a matrix of `jac_f`, column by column.
    pub fn jacobian_of_jacobian(&self) -> ExternalPorts {
        let [_, jacobian, ..] = self.functions();
        let spare = |port: &Port| Port { name: format!("out_{}", port.name), full: false, ..port.clone() };
        let mut outputs = Vec::new();
        for (k, of) in jacobian.outputs.iter().enumerate() {
            let curved = self.curved.get(k % self.inputs.len().max(1));
            for (j, by) in jacobian.inputs.iter().enumerate() {
                outputs.push(Port {
                    name: format!("jac_{}_{}", of.name, by.name),
                    rows: of.rows * of.columns,
                    columns: by.rows * by.columns,
                    full: curved.and_then(|row| row.get(j)).is_some_and(|curved| *curved),
                });
            }
        }
        let inputs = jacobian.inputs.iter().cloned().chain(jacobian.outputs.iter().map(spare)).collect();
        ExternalPorts { prefix: "jac_jac_", inputs, outputs }
    }

    fn slopes(&self) -> Vec<Port> {
        let slope = |of: &Variable, by: &Variable| Port {
            name: format!("jac_{}_{}", of.name, by.name),
            rows: of.entries(),
            columns: by.entries(),
            full: true,
        };
        self.outputs.iter().flat_map(|of| self.inputs.iter().map(move |by| slope(of, by))).collect()
    }

    fn curvatures(&self) -> Vec<Port> {
        let mut all = Vec::new();
        for (of, curved) in self.inputs.iter().zip(&self.curved) {
            let mut push = |prefix: &str, by: &Variable, full| {
                let name = format!("jac_adj_{}_{prefix}{}", of.name, by.name);
                all.push(Port { name, rows: of.entries(), columns: by.entries(), full });
            };
            self.inputs.iter().zip(curved).for_each(|(by, curved)| push("", by, *curved));
            self.outputs.iter().for_each(|by| push("out_", by, false));
            self.outputs.iter().for_each(|by| push("adj_", by, true));
        }
        all
    }
}
