import QtQuick
import Usher.Tablet

// The building with places, route and the robot, as large as it fits; north is up.
Item {
    id: view

    required property double u
    required property ScreenModel model
    property bool animate: true
    readonly property double fit: model.planWidth > 0
                                  ? Math.min(width / model.planWidth, height / model.planHeight) : 0

    Accessible.role: Accessible.Graphic
    Accessible.name: model.hereLabel

    Rectangle {
        anchors.fill: parent
        radius: 28 * view.u
        color: Theme.surface
        visible: view.fit === 0
    }
    FloorPlanItem {
        id: plan
        objectName: "floorPlan"
        anchors.centerIn: parent
        width: view.model.planWidth * view.fit
        height: view.model.planHeight * view.fit
        screen: view.model
        textSize: Theme.mapNameSize * view.u

        Item {
            id: robot
            objectName: "robot"
            visible: view.model.located
            // The pose comes five times a second; in between the robot glides.
            property double planX: view.model.robotX
            property double planY: view.model.robotY
            x: planX * view.fit
            y: planY * view.fit
            Behavior on planX {
                enabled: view.animate && robot.visible
                NumberAnimation { duration: 200 }
            }
            Behavior on planY {
                enabled: view.animate && robot.visible
                NumberAnimation { duration: 200 }
            }

            Rectangle {
                anchors.centerIn: parent
                width: 92 * view.u
                height: width
                radius: width / 2
                color: Theme.robot
                opacity: 0.3
            }
            Item {
                rotation: view.model.robotDegrees
                Rectangle {
                    x: 12 * view.u
                    y: -10 * view.u
                    width: 44 * view.u
                    height: 20 * view.u
                    radius: 10 * view.u
                    color: Theme.robot
                }
            }
            Rectangle {
                anchors.centerIn: parent
                width: 48 * view.u
                height: width
                radius: width / 2
                color: Theme.robot
                border.width: 6 * view.u
                border.color: Theme.ink
            }
        }
        PlaceNamesItem {
            id: names
            objectName: "placeNames"
            anchors.fill: parent
            screen: view.model
            textSize: Theme.mapNameSize * view.u
            robot: Qt.point(robot.x, robot.y)
            robotReach: 56 * view.u
            signSize: Qt.size(here.width, here.height)
        }
        Rectangle {
            id: here
            objectName: "here"
            visible: view.model.located && view.model.page === ScreenModel.Map
            x: names.signPosition.x
            y: names.signPosition.y
            width: hereText.implicitWidth + 36 * view.u
            height: hereText.implicitHeight + 16 * view.u
            radius: 16 * view.u
            color: Theme.robot
            Text {
                id: hereText
                anchors.centerIn: parent
                text: view.model.hereLabel
                color: Theme.ink
                font.pixelSize: Theme.mapNameSize * view.u
                font.weight: Font.DemiBold
            }
        }
    }
}
