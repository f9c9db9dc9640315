;; Replays a tape inside WebAssembly, since a call from Python takes longer than a step. An entry has 16 bytes: what to do
;; (0: step, 1: set a Real, 2: an Integer or enumeration, 3: a Boolean), a value reference, and the step size or value.
(module
  (import "web" "memory" (memory 1))
  (import "web" "step" (func $step (param f64) (result i32)))
  (import "web" "set_reals" (func $set_reals (param i32 i32 i32) (result i32)))
  (import "web" "set_integers" (func $set_integers (param i32 i32 i32) (result i32)))
  (import "web" "set_booleans" (func $set_booleans (param i32 i32 i32) (result i32)))
  (import "web" "get" (func $get (param i32 i32 i32 i32 i32)))

  ;; Whether an entry that sets something was refused.
  (func $set (param $at i32) (result i32) (local $what i32) (local $of i32) (local $value i32)
    (local.set $what (i32.load (local.get $at)))
    (local.set $of (i32.add (local.get $at) (i32.const 4)))
    (local.set $value (i32.add (local.get $at) (i32.const 8)))
    (if (i32.eq (local.get $what) (i32.const 1))
      (then (return (call $set_reals (local.get $of) (i32.const 1) (local.get $value)))))
    (if (i32.eq (local.get $what) (i32.const 2))
      (then (return (call $set_integers (local.get $of) (i32.const 1) (local.get $value)))))
    (call $set_booleans (local.get $of) (i32.const 1) (local.get $value)))

  ;; From entry $at up to $end; after each step a row of the listed variables is put to $row. The answer is 0, or the place
  ;; of the entry that was refused.
  (func (export "replay") (param $at i32) (param $end i32) (param $list i32) (param $reals i32) (param $integers i32)
      (param $booleans i32) (param $row i32) (result i32)
    (block $done
      (loop $next
        (br_if $done (i32.ge_u (local.get $at) (local.get $end)))
        (if (i32.load (local.get $at))
          (then (if (call $set (local.get $at)) (then (return (local.get $at)))))
          (else
            (if (call $step (f64.load offset=8 (local.get $at))) (then (return (local.get $at))))
            (call $get (local.get $list) (local.get $reals) (local.get $integers) (local.get $booleans) (local.get $row))
            (local.set $row (i32.add (local.get $row)
              (i32.mul (i32.const 8)
                (i32.add (local.get $reals) (i32.add (local.get $integers) (local.get $booleans))))))))
        (local.set $at (i32.add (local.get $at) (i32.const 16)))
        (br $next)))
    (i32.const 0)))
