# find_package(Etendue) gives two targets; a program links one of them.
#   Etendue::etendue  the kernel, freestanding (etendue.h)
#   Etendue::host     the kernel and the host (etendue.h, etendue_host.h)
get_filename_component(_etendue_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)

foreach(_etendue_target IN ITEMS etendue host)
    if(NOT TARGET Etendue::${_etendue_target})
        add_library(Etendue::${_etendue_target} STATIC IMPORTED)
        set_target_properties(Etendue::${_etendue_target} PROPERTIES
            INTERFACE_INCLUDE_DIRECTORIES "${_etendue_prefix}/include"
            IMPORTED_LINK_INTERFACE_LANGUAGES "C")
    endif()
endforeach()
set_target_properties(Etendue::etendue PROPERTIES IMPORTED_LOCATION "${_etendue_prefix}/lib/libetendue.a")
set_target_properties(Etendue::host PROPERTIES
    IMPORTED_LOCATION "${_etendue_prefix}/lib/libetendue_host.a"
    INTERFACE_LINK_LIBRARIES "@NEEDED@")

unset(_etendue_prefix)
unset(_etendue_target)
