#include <QQmlEngine>
#include <QtQuickTest>

extern void qml_register_types_Usher_Tablet();

/// Makes the module known to the engine of the tests.
class Setup : public QObject {
  Q_OBJECT

 public slots:
  void qmlEngineAvailable(QQmlEngine* engine) {
    qml_register_types_Usher_Tablet();
    engine->addImportPath("qrc:/");
  }
};

QUICK_TEST_MAIN_WITH_SETUP(tablet, Setup)

#include "qml_test.moc"
