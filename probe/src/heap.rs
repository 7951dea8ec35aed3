//! A heap in a fixed block of memory: what was allocated last can be given back, the rest is lost.

use core::alloc::{GlobalAlloc, Layout};
use core::cell::UnsafeCell;

#[cfg(target_arch = "x86_64")]
const SIZE: usize = 256 << 20;
#[cfg(not(target_arch = "x86_64"))]
const SIZE: usize = 1 << 20;

struct Heap {
    memory: UnsafeCell<[u8; SIZE]>,
    used: UnsafeCell<usize>,
}

// SAFETY: there is one thread.
unsafe impl Sync for Heap {}

// SAFETY: blocks are aligned, lie apart within `memory`, and are handed out once; `used` is touched by
// one thread only.
unsafe impl GlobalAlloc for Heap {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let used = self.used.get();
        let base = self.memory.get().cast::<u8>();
        // SAFETY: as above.
        unsafe {
            let address = base as usize + *used;
            let start = address.next_multiple_of(layout.align()) - base as usize;
            let end = start + layout.size();
            if end > SIZE {
                return core::ptr::null_mut();
            }
            *used = end;
            base.add(start)
        }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        let used = self.used.get();
        let start = block as usize - self.memory.get() as usize;
        // SAFETY: as above.
        unsafe {
            if start + layout.size() == *used {
                *used = start;
            }
        }
    }
}

#[global_allocator]
static HEAP: Heap = Heap {
    memory: UnsafeCell::new([0; SIZE]),
    used: UnsafeCell::new(0),
};
