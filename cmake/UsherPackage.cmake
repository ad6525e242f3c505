# `cpack` makes a Debian package that depends on the run-time libraries only.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The Usher developers <usher@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS opencv-data)  # the cascades of face_detector
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
include(CPack)
