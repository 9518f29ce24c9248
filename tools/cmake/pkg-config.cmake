# Writes and installs dovetail_kernel.pc and dovetail.pc, for builds without CMake:
#
#     c++ -std=c++20 program.cpp $(pkg-config --cflags --libs dovetail)
#
# Both libraries are static, so all that they need stands under Libs. What has no .pc file that is called alike
# everywhere (MPI, Boost.MPI, parallel HDF5) is named by where CMake found it. The prefix is relative to the file, so
# an installation may be moved.
set(pc_directory "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
file(RELATIVE_PATH pc_to_prefix "${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig" "${CMAKE_INSTALL_PREFIX}")
string(REGEX REPLACE "/$" "" pc_to_prefix "${pc_to_prefix}")
file(RELATIVE_PATH pc_libdir "${CMAKE_INSTALL_PREFIX}" "${CMAKE_INSTALL_FULL_LIBDIR}")
file(RELATIVE_PATH pc_includedir "${CMAKE_INSTALL_PREFIX}" "${CMAKE_INSTALL_FULL_INCLUDEDIR}")

# dovetail_pc_file(NAME DESCRIPTION text REQUIRES names LIBS flags CFLAGS flags)
function(dovetail_pc_file name)
  cmake_parse_arguments(arg "" "DESCRIPTION;REQUIRES" "LIBS;CFLAGS" ${ARGN})
  list(JOIN arg_LIBS " " libs)
  list(JOIN arg_CFLAGS " " cflags)
  file(GENERATE OUTPUT "${PROJECT_BINARY_DIR}/${name}.pc" CONTENT "prefix=\${pcfiledir}/${pc_to_prefix}
libdir=\${prefix}/${pc_libdir}
includedir=\${prefix}/${pc_includedir}

Name: ${name}
Description: ${arg_DESCRIPTION}
Version: ${PROJECT_VERSION}
Requires: ${arg_REQUIRES}
Libs: -L\${libdir} -l${name} ${libs}
Cflags: -I\${includedir} ${cflags}
")
  install(FILES "${PROJECT_BINARY_DIR}/${name}.pc" DESTINATION "${pc_directory}")
endfunction()

dovetail_pc_file(dovetail_kernel DESCRIPTION "Exact two-dimensional Delaunay triangulation in one process, without MPI"
                 REQUIRES "fmt >= 9" CFLAGS -ffp-contract=off)

set(pc_cflags ${MPI_CXX_COMPILE_OPTIONS})
foreach(directory IN LISTS MPI_CXX_INCLUDE_DIRS Boost_INCLUDE_DIRS)
  if(NOT directory IN_LIST CMAKE_CXX_IMPLICIT_INCLUDE_DIRECTORIES)
    list(APPEND pc_cflags "-I${directory}")
  endif()
endforeach()
foreach(definition IN LISTS MPI_CXX_COMPILE_DEFINITIONS)
  list(APPEND pc_cflags "-D${definition}")
endforeach()
list(REMOVE_DUPLICATES pc_cflags)
set(pc_libs "$<TARGET_LINKER_FILE:Boost::mpi>" "$<TARGET_LINKER_FILE:Boost::serialization>")
foreach(library IN LISTS HDF5_C_LIBRARIES PNG_LIBRARIES MPI_CXX_LIBRARIES)
  if(library MATCHES "^[-/]")
    list(APPEND pc_libs "${library}")
  else()
    list(APPEND pc_libs "-l${library}")
  endif()
endforeach()
list(REMOVE_DUPLICATES pc_libs)
dovetail_pc_file(dovetail DESCRIPTION "${PROJECT_DESCRIPTION}" REQUIRES "dovetail_kernel = ${PROJECT_VERSION}"
                 LIBS ${pc_libs} CFLAGS ${pc_cflags})
