/* In place of the library of the same name, which Wine lacks before version 8.21: Rust's standard library seeds its hash
   tables with this function. Compiled into a DLL beside `cg.exe` by `make windows`; Windows has its own. */
#include <windows.h>

BOOLEAN NTAPI SystemFunction036(PVOID bytes, ULONG count); /* RtlGenRandom of advapi32 */

__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE bytes, SIZE_T count) { return SystemFunction036(bytes, count); }
