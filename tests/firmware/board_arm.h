/* Input and output of board_filter.c on a Cortex-M in QEMU: files by semihosting, instructions by SysTick.

   It reads samples.bin and writes result.bin: u32 ticks, then what the board sends. QEMU counts 64 ns for each
   instruction (-icount shift=6), and SysTick runs at 25 MHz: 1.6 ticks are an instruction. The last number is the
   largest depth of the stack in bytes.
*/
#define STACK_BYTES 8192u
#define PAINT 0xc5c5c5c5u
#define SYS_OPEN 0x01
#define SYS_WRITE 0x05
#define SYS_READ 0x06
#define SYS_EXIT 0x18

#define SYST_CSR (*(volatile uint32_t *)0xe000e010u)
#define SYST_RVR (*(volatile uint32_t *)0xe000e014u)
#define SYST_CVR (*(volatile uint32_t *)0xe000e018u)
#define CPACR (*(volatile uint32_t *)0xe000ed88u)

int main(void);

static uint32_t board_stack[STACK_BYTES / 4];
static uintptr_t board_samples, board_result;
static uint32_t board_began;

static void board_reset(void) {
#ifdef __ARM_FP
  CPACR |= 0xfu << 20; /* switches the FPU on */
#endif
  main();
}

__attribute__((section(".vectors"), used)) static const void *const board_vectors[] = {
    &board_stack[STACK_BYTES / 4], (const void *)board_reset};

static uintptr_t board_call(uintptr_t operation, const void *arguments) {
  register uintptr_t r0 __asm__("r0") = operation;
  register const void *r1 __asm__("r1") = arguments;
  __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

static uintptr_t board_open(const char *name, uintptr_t mode) {
  const uintptr_t arguments[] = {(uintptr_t)name, mode, strlen(name)};
  return board_call(SYS_OPEN, arguments);
}

static void board_write(const void *from, uint32_t bytes) {
  const uintptr_t arguments[] = {board_result, (uintptr_t)from, bytes};
  board_call(SYS_WRITE, arguments);
}

static void board_begin(void) {
  const uint32_t *const here = (const uint32_t *)__builtin_frame_address(0);
  uint32_t *next;
  for (next = board_stack; next < here - 16; ++next) {
    *next = PAINT;
  }
  board_samples = board_open("samples.bin", 1);
  board_result = board_open("result.bin", 5);
  SYST_RVR = 0xffffffu;
  SYST_CVR = 0;
  SYST_CSR = 5; /* on, by the clock of the processor */
}

static void board_end(void) {
  const uintptr_t reason = 0x20026; /* the program has ended */
  uint32_t unused = 0, depth;
  while (board_stack[unused] == PAINT) {
    ++unused;
  }
  depth = STACK_BYTES - 4 * unused;
  board_write(&depth, sizeof depth);
  board_call(SYS_EXIT, (const void *)reason);
}

static void board_read(void *to, uint32_t bytes) {
  const uintptr_t arguments[] = {board_samples, (uintptr_t)to, bytes};
  if (board_call(SYS_READ, arguments) != 0) {
    board_end();
  }
}

static void board_mark(int mark) {
  const uint32_t now = SYST_CVR;
  if (mark == 1) {
    board_began = now;
  } else {
    const uint32_t ticks = (board_began - now) & 0xffffffu;
    board_write(&ticks, sizeof ticks);
  }
}
