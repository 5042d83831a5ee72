/* Header and library fit. */

#include <etendue.h>

int main(void)
{
    return etd_abi_version() == ETD_ABI_VERSION ? 0 : 1;
}
