//! How a process starts, writes and ends on a machine: on x86-64 by calls of Linux, elsewhere not at
//! all.

#[cfg(target_arch = "x86_64")]
core::arch::global_asm!(
    ".globl _start",
    "_start:",
    "xor ebp, ebp",
    "and rsp, -16",
    "call probe",
    "ud2",
);

#[cfg(target_arch = "x86_64")]
fn call(number: usize, arguments: [usize; 3]) {
    let [first, second, third] = arguments;
    // SAFETY: the two calls that are made, `write` and `exit`, read the memory of a string and nothing
    // else.
    unsafe {
        core::arch::asm!(
            "syscall",
            inlateout("rax") number => _,
            in("rdi") first,
            in("rsi") second,
            in("rdx") third,
            out("rcx") _,
            out("r11") _,
        );
    }
}

/// Writes a text to the standard output.
#[cfg(target_arch = "x86_64")]
pub fn print(text: &str) {
    call(1, [1, text.as_ptr() as usize, text.len()]);
}

/// Ends the process.
#[cfg(target_arch = "x86_64")]
pub fn exit(code: u8) -> ! {
    loop {
        call(60, [usize::from(code), 0, 0]);
    }
}

/// There is nowhere to write.
#[cfg(not(target_arch = "x86_64"))]
pub fn print(_: &str) {}

/// There is nowhere to go.
#[cfg(not(target_arch = "x86_64"))]
pub fn exit(_: u8) -> ! {
    loop {
        core::hint::spin_loop();
    }
}

#[cfg(not(target_arch = "x86_64"))]
#[unsafe(no_mangle)]
extern "C" fn _start() -> ! {
    crate::probe()
}
