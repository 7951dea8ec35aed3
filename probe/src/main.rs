//! Proves that `sim-core` needs no operating system: no standard library, no libc, an allocator and a
//! panic handler of its own. It links for bare machines; on x86-64 Linux runs the same file as a
//! process, and its exit code says whether the hash of all motion is the one that it is everywhere.

#![no_std]
#![no_main]

extern crate alloc;

mod heap;
mod machine;
mod motion;

use machine::{exit, print};

/// The first function, once there is a stack.
#[unsafe(no_mangle)]
extern "C" fn probe() -> ! {
    let Some(hash) = motion::hash() else {
        print("a step failed\n");
        exit(2)
    };
    let digits = core::array::from_fn::<u8, 16, _>(|place| {
        b"0123456789abcdef"[(hash >> (60 - 4 * place) & 15) as usize]
    });
    print(core::str::from_utf8(&digits).unwrap_or_default());
    if hash == motion::EXPECTED {
        print(", as everywhere\n");
        exit(0)
    }
    print(" is another hash\n");
    exit(1)
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    print("a panic\n");
    exit(101)
}
