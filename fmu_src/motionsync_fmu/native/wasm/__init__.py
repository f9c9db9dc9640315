"""The unit of FMI 3.0 as a WebAssembly component, by the draft of the layered standard fmi-ls-wasm."""
