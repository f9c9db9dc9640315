"""The kernel subset: the small, plain Python of the model that is also compiled to native code.

`module_rules.check` walks the syntax trees of the model's modules and returns what is outside the subset: file, line
and rule. Visiting an expression applies its rules and returns the kind of its value; visiting a statement updates
`bound`, the locals that certainly have a value at that point. What a type checker reports anyway (a field that does not
exist, a wrong argument) is not checked here.
"""
